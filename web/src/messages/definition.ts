/**
 * Reads the definition of a type, as the hub sends it with a subscription: the text of a message, and
 * those of all messages in it (https://wiki.ros.org/msg), each after a line of `=` and its name.
 */

/** The fields of a message; lists of them begin with the requested type. */
export interface Definition {
  readonly type: string;
  readonly fieldnames: readonly string[];
  /** Full names, without the brackets of arrays. */
  readonly fieldtypes: readonly string[];
  /** -1: not an array, 0: an array of any length, n: an array of n elements. */
  readonly fieldarraylen: readonly number[];
}

const BUILTIN = new Set([
  ...["bool", "byte", "char", "float32", "float64", "string", "wstring", "time", "duration"],
  ...["8", "16", "32", "64"].flatMap((bits) => [`int${bits}`, `uint${bits}`]),
]);

/** Names that mean another type, in each package. */
const ALIASES: Readonly<Record<string, string>> = {
  Header: "std_msgs/Header",
  "builtin_interfaces/Time": "time",
  "builtin_interfaces/Duration": "duration",
};

/** A field; what follows its name is a default of ROS 2, or a comment. */
const FIELD =
  /^(?<type>[A-Za-z][\w/]*)(?:<=\d+)?(?<array>\[(?<bounded><=)?(?<size>\d+)?\])?\s+(?<name>\w+)(?!\w|\s*=)/;

/** Read the definition of a type, whose text names its own package's types without the package. */
export function readDefinition(type: string, text: string): Definition[] {
  const [own = "", ...others] = text.split(/^=+[ \t]*\r?\n(?=MSG:)/m);
  return [
    message(type, own),
    ...others.map((each) => {
      const [, name = "", body = ""] = /^MSG:\s*(\S+)[^\n]*\n?([\s\S]*)$/.exec(each) ?? [];
      return message(name.replace("/msg/", "/"), body);
    }),
  ];
}

function message(type: string, text: string): Definition {
  const package_ = type.split("/")[0] ?? "";
  const fields = text.split("\n").flatMap((line): Record<string, string>[] => {
    const groups = FIELD.exec(line.trim())?.groups;
    return groups === undefined ? [] : [groups];
  });
  return {
    type,
    fieldnames: fields.map(({ name = "" }) => name),
    fieldtypes: fields.map((each) => fullName(each.type ?? "", package_)),
    fieldarraylen: fields.map(({ array, bounded, size }) => {
      if (array === undefined) return -1;
      return bounded === undefined ? Number(size ?? 0) : 0;
    }),
  };
}

function fullName(type: string, package_: string): string {
  const name = type.replace("/msg/", "/");
  if (BUILTIN.has(name)) return name;
  return ALIASES[name] ?? (name.includes("/") ? name : `${package_}/${name}`);
}
