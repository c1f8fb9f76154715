/** Light or dark colors of the app: as the system has them, or as a person chose; kept in the browser. */

import { recalled, remember } from "./storage";

export type Scheme = "light dark" | "light" | "dark";

export const SCHEMES: readonly [Scheme, string][] = [
  ["light dark", "Colors of the system"],
  ["light", "Light colors"],
  ["dark", "Dark colors"],
];
const KEY = "distal:colors";

export function schemeNow(): Scheme {
  return (document.documentElement.style.colorScheme as Scheme) || "light dark";
}

export function useScheme(scheme: Scheme): void {
  document.documentElement.style.colorScheme = scheme;
  remember("localStorage", KEY, scheme); // Without storage the choice ends with the page.
}

/** The colors of the last visit. */
export function recallScheme(): void {
  const last = recalled("localStorage", KEY);
  if (SCHEMES.some(([scheme]) => scheme === last)) document.documentElement.style.colorScheme = last!;
}
