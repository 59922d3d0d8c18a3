// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Elements, and numbers as people read them.

type Child = Node | string;
type Properties = { class?: string; title?: string; [name: string]: unknown };

export function make<K extends keyof HTMLElementTagNameMap>(tag: K, properties: Properties = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (value === undefined) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value as EventListener);
    else if (name === "class") element.className = String(value);
    else element.setAttribute(name, String(value));
  }
  element.append(...children);
  return element;
}

const ICONS = {
  fit: "M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5",
  top: "M12 3v10m0 0-4-4m4 4 4-4M4 17l8 4 8-4",
  layers: "m12 4 9 5-9 5-9-5zM3 14l9 5 9-5",
  help: "M9 9a3 3 0 1 1 4.2 2.7c-.9.4-1.2 1-1.2 2M12 17.5v.01M12 3a9 9 0 1 0 0 18 9 9 0 0 0 0-18z",
  ruler: "M3 16 16 3l5 5L8 21zM7 12l2 2M10 9l2 2M13 6l2 2",
  theme: "M12 4a8 8 0 1 0 8 8 6 6 0 0 1-8-8z",
  open: "M3 19V6h6l2 2h10v11zM12 11v5m0-5-2.2 2.2M12 11l2.2 2.2",
  play: "M8 5v14l11-7z",
  pause: "M8 5v14M16 5v14",
  close: "M6 6l12 12M18 6 6 18",
  follow: "M12 12m-3 0a3 3 0 1 0 6 0a3 3 0 1 0-6 0M12 3v4M12 17v4M3 12h4M17 12h4",
  image: "M4 5h16v14H4zM4 16l5-5 4 4 3-3 4 4M15 9v.01",
  eye: "M2 12s4-6 10-6 10 6 10 6-4 6-10 6S2 12 2 12zM12 12m-2.5 0a2.5 2.5 0 1 0 5 0a2.5 2.5 0 1 0-5 0",
} as const;

export function icon(name: keyof typeof ICONS): SVGSVGElement {
  const space = "http://www.w3.org/2000/svg";
  const svg = document.createElementNS(space, "svg");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("aria-hidden", "true");
  const path = document.createElementNS(space, "path");
  path.setAttribute("d", ICONS[name]);
  svg.append(path);
  return svg;
}

// A number with what it is, in a list of such.
export class Figure {
  readonly element: HTMLElement;
  private readonly value = make("dd");
  private readonly unit = make("dt");

  constructor(key: string, title?: string) { this.element = make("div", { title, "data-key": key }, this.value, this.unit); }

  show(value: string, unit: string, kind = ""): void {
    if (this.element.className !== kind) this.element.className = kind;
    setText(this.value, value);
    setText(this.unit, unit);
  }
}

export function button(name: keyof typeof ICONS, title: string, onclick: () => void, text = ""): HTMLButtonElement {
  const children: Child[] = [icon(name)];
  if (text !== "") children.push(text);
  return make("button", { type: "button", title, "aria-label": title, onclick }, ...children);
}

// Only where it differs, so that nothing is laid out again for nothing.
export function setText(element: HTMLElement, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

const whole = new Intl.NumberFormat("en", { maximumFractionDigits: 0 });
export const count = (value: number): string => whole.format(value);
export const digits = (value: number | null | undefined, places: number): string => (value === null || value === undefined || !Number.isFinite(value) ? "–" : value.toFixed(places));
export const plural = (value: number, one: string, many = `${one}s`): string => `${count(value)} ${value === 1 ? one : many}`;

// "2.1 cm"; in units of the map where the scale is not known.
export function length(value: number, unit: string): string {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  if (unit !== "m") return `${value.toPrecision(2)} ${unit}`;
  if (value >= 1) return `${value.toFixed(2)} m`;
  return value >= 0.01 ? `${(100 * value).toFixed(1)} cm` : `${(1000 * value).toFixed(1)} mm`;
}

// "5 m", "1 unit": how large a square of the grid is.
export function gridText(cell: number, unit: string): string {
  const size = Number(cell.toPrecision(3));
  return `grid ${size} ${size === 1 && unit === "units" ? "unit" : unit}`;
}

export function seconds(value: number | null): string {
  if (value === null || !Number.isFinite(value)) return "–";
  return value < 1 ? `${Math.round(1000 * value)} ms` : `${value.toFixed(1)} s`;
}

// "1:02.4"
export function clock(t_s: number): string {
  const sign = t_s < 0 ? "-" : "";
  const tenths = Math.round(Math.abs(t_s) * 10);
  const [hours, minutes] = [Math.floor(tenths / 36000), Math.floor(tenths / 600) % 60];
  const rest = ((tenths % 600) / 10).toFixed(1).padStart(4, "0");
  return hours > 0 ? `${sign}${hours}:${String(minutes).padStart(2, "0")}:${rest}` : `${sign}${minutes}:${rest}`;
}
