/** Offers a file that the browser saves. */
export function download(content: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = fileName(name);
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

/** What file systems take of a name. */
function fileName(name: string): string {
  return name.replace(/[^\p{L}\p{N}._ -]+/gu, "-");
}
