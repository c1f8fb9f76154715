declare module "*.css" {
  const text: string;
  export default text;
}

/** Whether this is the script of pages with paths; a constant of the build. */
declare const PATHS: boolean;
/** Whether another payload can take the place of the first, as in an editor. */
declare const EDITED: boolean;
/** Whether this is the script of pages of pictures that keep frames; see `frames.ts`. */
declare const FRAMES: boolean;
