declare module "*.css" {
  const text: string;
  export default text;
}

/** Whether this is the script of pages with paths; a constant of the build. */
declare const PATHS: boolean;
