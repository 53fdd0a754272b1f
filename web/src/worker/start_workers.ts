/** Workers, as files beside the page's code. The package has them in its own (package/inline_workers.ts). */
export function startCaseWorker(): Worker {
  return new Worker(new URL("./case_worker.ts", import.meta.url), { type: "module" });
}

export function startSectionWorker(): Worker {
  return new Worker(new URL("./section_worker.ts", import.meta.url), { type: "module" });
}
