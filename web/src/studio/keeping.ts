/** Where unsaved texts outlive the page: the studio's server, or the playground's scenes. */
export interface Keeping {
  /** A text changed: it is kept soon. */
  changed(): void;
  /** Keeps all unsaved texts now: before a compilation, and when the page ends. */
  keep(): void;
}
