/** What a person takes along: a file, a text. Works on pages opened from disk. */

/** Hands a file to the browser as a download; the name keeps only what every disk allows. */
export function save(file: Blob, name: string, suffix = "png"): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(file);
  link.download = `${fileName(name)}.${suffix}`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

export function fileName(name: string): string {
  return name.replace(/[^\p{L}\p{N}._-]+/gu, "-").replace(/^[-.]+|[-.]+$/g, "") || "picture";
}

/** Puts a text on the clipboard, the old way where the new one is refused. */
export async function copy(text: string, root: ShadowRoot): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    const field = document.createElement("textarea");
    field.className = "aloud";
    field.value = text;
    const { activeElement } = root;
    root.append(field);
    field.select();
    const isCopied = document.execCommand("copy");
    field.remove();
    (activeElement as HTMLElement | null)?.focus();
    return isCopied;
  }
}
