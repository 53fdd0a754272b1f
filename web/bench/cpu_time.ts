import { readdirSync, readFileSync } from "node:fs";

const kTicksMs = 10; // of /proc

/** What all processes that this one has started have computed since, ms: waits for other programs are not in it. */
export function childrenCpuMs(): number {
  const processes = new Map<number, { parent: number; ms: number }>();
  for (const pid of readdirSync("/proc").filter((name) => /^\d+$/.test(name))) {
    try {
      const fields = readFileSync(`/proc/${pid}/stat`, "utf8")
        .replace(/^.*\) /, "")
        .split(" ");
      processes.set(Number(pid), {
        parent: Number(fields[1]),
        ms: kTicksMs * (Number(fields[11]) + Number(fields[12])),
      });
    } catch {
      // It has ended meanwhile.
    }
  }
  const isOurs = (pid: number): boolean => {
    const parent = processes.get(pid)?.parent;
    return parent !== undefined && (parent === process.pid || isOurs(parent));
  };
  return [...processes].reduce((sum, [pid, { ms }]) => sum + (isOurs(pid) ? ms : 0), 0);
}
