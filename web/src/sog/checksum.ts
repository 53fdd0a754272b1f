import { CaseError, crc32 } from "./zip";

/** As a case states it (docs/format.md). */
function checksum(bytes: Uint8Array): string {
  return crc32(bytes).toString(16).padStart(8, "0");
}

/**
 * Throws CaseError unless what was decoded of a case's file is what its checksum says; undefined: an older case, which
 * says nothing.
 */
export function requireChecksum(stated: unknown, bytes: Uint8Array, file: string): void {
  if (stated !== undefined && stated !== checksum(bytes)) {
    throw new CaseError(
      `${file} does not decode to what was written (its checksum differs), so it is not shown; copy the case again, or use another browser`,
    );
  }
}

/** The same of an image's texels, by what the `clipgs` block of a case says. */
export function requireTexelChecksum(clipgs: unknown, rgba: Uint8Array, file: string): void {
  const checksums = (clipgs as { checksums?: Record<string, unknown> } | null | undefined)?.checksums;
  if (checksums !== undefined) {
    requireChecksum(checksums?.[file] ?? null, rgba, file);
  }
}
