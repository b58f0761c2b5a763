/** The files of what is dropped on the page: those of a folder, too, such as one of rosbag2. */

/** Files that are shown together, and the name of all. */
export interface Files {
  readonly name: string;
  readonly files: readonly File[];
}

export async function filesOf(entries: readonly (FileSystemEntry | File)[]): Promise<Files> {
  const files: File[] = [];
  for (const entry of entries) {
    if (entry instanceof File) files.push(entry);
    else if (isFolder(entry)) for (const each of await childrenOf(entry)) files.push(each);
    else files.push(await fileOf(entry as FileSystemFileEntry));
  }
  return { name: entries[0]?.name ?? "", files };
}

function isFolder(entry: FileSystemEntry): entry is FileSystemDirectoryEntry {
  return entry.isDirectory;
}

function fileOf(entry: FileSystemFileEntry): Promise<File> {
  return new Promise((resolve, reject) => entry.file(resolve, reject));
}

/** The files of a folder, without those of folders in it. */
async function childrenOf(folder: FileSystemDirectoryEntry): Promise<File[]> {
  const reader = folder.createReader();
  const found: File[] = [];
  // Browsers have them a hundred at a time.
  for (;;) {
    const some = await new Promise<FileSystemEntry[]>((resolve, reject) =>
      reader.readEntries(resolve, reject),
    );
    if (some.length === 0) return found;
    for (const entry of some)
      if (entry.isFile) found.push(await fileOf(entry as FileSystemFileEntry));
  }
}
