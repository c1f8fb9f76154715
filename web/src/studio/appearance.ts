/** Light or dark colors of the app: as the system has them, or as a person chose; kept in the browser. */

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
  try {
    localStorage.setItem(KEY, scheme);
  } catch {
    // Without storage the choice ends with the page.
  }
}

/** The colors of the last visit. */
export function recallScheme(): void {
  try {
    const found = localStorage.getItem(KEY);
    if (SCHEMES.some(([scheme]) => scheme === found)) document.documentElement.style.colorScheme = found!;
  } catch {
    // No storage.
  }
}
