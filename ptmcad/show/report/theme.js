"use strict";
// The page's data; light and dark, the copy buttons, and what is said to those who do not see.

const DATA = JSON.parse(document.getElementById("data").textContent);

function svg(name, attributes, text) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const key in attributes) element.setAttribute(key, attributes[key]);
  if (text !== undefined) element.textContent = text;
  return element;
}

function html(name, className, text) {
  const element = document.createElement(name);
  if (className) element.className = className;
  if (text !== undefined) element.textContent = text;
  return element;
}

function say(text) {
  document.getElementById("said").textContent = text;
}

const theme = {
  button: document.getElementById("theme"),
  system: window.matchMedia("(prefers-color-scheme: dark)"),
  changed: [],
  dark() {
    const chosen = document.documentElement.dataset.theme;
    return chosen ? chosen === "dark" : theme.system.matches;
  },
  show() {
    theme.button.setAttribute("aria-pressed", String(theme.dark()));
    theme.button.textContent = theme.dark() ? "Dark: on" : "Dark: off";
    for (const redraw of theme.changed) redraw();
  },
};
theme.button.addEventListener("click", () => {
  document.documentElement.dataset.theme = theme.dark() ? "light" : "dark";
  theme.show();
});
theme.system.addEventListener("change", theme.show);
window.matchMedia("print").addEventListener("change", theme.show); // paper has colours of its own
theme.show();

// On paper nothing can be unfolded.
const folded = { details: [] };
window.addEventListener("beforeprint", () => {
  folded.details = [...document.querySelectorAll("details:not([open])")];
  for (const details of folded.details) details.open = true;
});
window.addEventListener("afterprint", () => {
  for (const details of folded.details) details.open = false;
});

async function copy(text) {
  if (navigator.clipboard && window.isSecureContext) {
    try {
      await navigator.clipboard.writeText(text);
      return true;
    } catch (refused) {
      // the older way below may still be allowed
    }
  }
  const area = html("textarea", "away");
  area.value = text;
  document.body.append(area);
  area.select();
  const done = document.execCommand("copy");
  area.remove();
  return done;
}

for (const button of document.querySelectorAll("button.copy")) {
  const label = button.textContent;
  let timer = 0;
  button.addEventListener("click", async () => {
    const done = await copy(button.parentElement.querySelector("code").textContent);
    button.textContent = done ? "Copied" : "Copying is not allowed here";
    button.focus();
    say(button.textContent);
    clearTimeout(timer);
    timer = setTimeout(() => { button.textContent = label; }, 2000);
  });
}
