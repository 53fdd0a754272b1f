// In place of src/worker/start_workers.ts: with its workers inside, the package can be served by another origin than the
// page's, as by a CDN, and bundlers have nothing to find beside it.
import CaseWorker from "../src/worker/case_worker?worker&inline";
import SectionWorker from "../src/worker/section_worker?worker&inline";

export const startCaseWorker = (): Worker => new CaseWorker();
export const startSectionWorker = (): Worker => new SectionWorker();
