/** The form for the token of a hub that wants one, and who the page is; loaded when they are needed. */
import "./login_form.css";

import { h, replace, setText } from "./dom";
import type { Hub } from "./hub";
import { ANONYMOUS, type Login } from "./login";

/** The hub's reason if there is no token at all. */
const MISSING = "missing token";

/** The form, which is visible while the hub wants a token that the page does not have. */
export function loginForm(hub: Hub, login: Login): HTMLElement {
  const problem = h("p", { class: "problem", id: "login-problem", role: "alert" });
  const input = h("input", {
    type: "password",
    id: "token",
    autocomplete: "current-password",
    autocapitalize: "none",
    spellcheck: "false",
    required: true,
    "aria-describedby": "login-problem",
  });
  const button = h("button", { class: "primary" }, "Log in");
  const submit = async (event: Event): Promise<void> => {
    event.preventDefault();
    button.disabled = true;
    const why = await login.logIn(input.value.trim());
    button.disabled = false;
    show(why);
    if (why === "") input.value = "";
    else input.select();
  };
  const form = h(
    "form",
    { class: "login", hidden: true, onsubmit: submit, "aria-labelledby": "login-title" },
    h("h2", { id: "login-title" }, "Log in"),
    h("p", {}, "This hub wants a token. Ask whoever runs it, or create one there:"),
    h("pre", {}, "fibws token add NAME --file FILE --subscribe '/**'"),
    // Password managers store a token under this name.
    h("input", { type: "text", autocomplete: "username", value: hub.url, hidden: true }),
    h("label", { for: "token" }, "Token"),
    h("div", { class: "row" }, input, button),
    // True for https and for this machine.
    !isSecureContext &&
      h("p", { class: "warning" }, "The connection is not encrypted: others may read the token."),
    problem,
  );
  const show = (why: string): void => {
    setText(problem, why === "" ? "" : `The hub refuses this page: ${why}.`);
  };
  hub.denied.watch((why) => {
    const appears = form.hidden && why !== "";
    form.hidden = why === "";
    // Nothing is wrong with a page that has no token yet.
    show(why === MISSING ? "" : why);
    if (appears) queueMicrotask(() => input.focus());
  });
  return form;
}

/** Who the page is, and a button to log out; empty if the hub wants no token. */
export function account(hub: Hub, login: Login): HTMLElement {
  const box = h("div", { id: "account" });
  login.who.watch((who) => {
    if (who === null || who.name === null) {
      replace(box);
      return;
    }
    const isAnonymous = who.name === ANONYMOUS;
    const title = who.admin ? `${who.name}, who may do everything` : who.name;
    const button = isAnonymous
      ? h("button", { type: "button", class: "quiet", onclick: () => hub.deny(MISSING) }, "Log in")
      : h(
          "button",
          { type: "button", class: "quiet", onclick: () => void login.logOut() },
          "Log out",
        );
    replace(box, h("span", { class: "principal", title }, who.name), button);
  });
  return box;
}
