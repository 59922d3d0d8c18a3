// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Light or dark: as the system has it, until somebody chooses.
const KEY = "coslam-theme";

const asked = (): string | null => {
  try {
    return localStorage.getItem(KEY);
  } catch {
    return null;  // no storage here
  }
};

export function startTheme(): void {
  const system = matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark";
  const theme = new URLSearchParams(location.search).get("theme") ?? asked() ?? system;
  document.documentElement.dataset["theme"] = theme === "light" ? "light" : "dark";
}

export function flipTheme(): void {
  const { dataset } = document.documentElement;
  dataset["theme"] = dataset["theme"] === "light" ? "dark" : "light";
  try {
    localStorage.setItem(KEY, dataset["theme"]);
  } catch {
    // no storage here
  }
}
