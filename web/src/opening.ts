import type { App } from "./app";
import type { OpenedCase } from "./host";
import { isSameVolume } from "./model/case_info";
import { type CaseSummary, failureText, type LoadingCase } from "./model/case_list";
import type { Link } from "./model/link";
import { CaseError } from "./sog/zip";
import { texts } from "./text/text";
import type { OpeningListener } from "./viewer";

/** Brings cases into an app: what is seen and said of one on its way, and what comes with it. */
export class Opening {
  readonly #app: App;
  #asked = 0; // cases
  #again = (): void => {}; // opens the one that was asked for last

  constructor(app: App) {
    this.#app = app;
    app.viewer.failed = ({ message }) => {
      this.end();
      app.offerLooks();
      app.message.say(message, this.#again);
    };
  }

  /**
   * Shows a case, in the view and cut that there are; the first one as it starts, unless `link` says more. Rejects with
   * CaseError, after saying so and offering to do it `again`.
   */
  async open({ name, file, error, ...said }: OpenedCase, link: Link, again: () => void): Promise<void> {
    const app = this.#app;
    const { viewer, loading, headset } = app;
    const asked = ++this.#asked;
    this.#again = again;
    app.message.dismiss();
    loading.begin(file, viewer.caseName !== null);
    const coming = { title: said.title ?? name, thumbnail: said.thumbnail ?? null, bytes: said.bytes ?? 0 };
    loading.name({ file, ...coming });
    headset.loading.value = { ...coming, share: 0 };
    try {
      if (error) {
        throw new CaseError(error);
      }
      const before = viewer.info;
      await viewer.open(name, file, this.#listener(coming, asked), () => {
        app.bar.showTitle(viewer.title);
        if (before === null) {
          this.#begin(link);
        }
      });
      if (!isSameVolume(before, viewer.info!)) {
        const isOwn = file instanceof File;
        await Promise.all([app.marks.bring(name, isOwn), app.views.bring(name, isOwn)]);
        app.actions.forget();
      }
    } catch (error) {
      if (asked === this.#asked) {
        this.end();
        app.offerLooks();
        app.update();
        app.message.say(failureText(name, error), again);
      }
      throw error;
    } finally {
      if (asked === this.#asked) {
        loading.end();
        headset.loading.value = null;
      }
    }
    this.#tellOfScale();
    this.#tellOfCase();
    if (app.bar.offersHeadset) {
      headset.prefetch();
    }
    if (viewer.sectionProblem) {
      app.message.say(viewer.sectionProblem, again);
    }
  }

  /** Puts a newer version of the case that is shown in its place; that stays where this fails. */
  async renew({ name, file }: Pick<CaseSummary, "name" | "file">): Promise<void> {
    try {
      if (await this.#app.viewer.renew(file)) {
        this.#tellOfCase();
      }
    } catch (error) {
      console.warn(failureText(name, error));
    }
  }

  /** Nothing is on its way. */
  end(): void {
    this.#app.loading.end();
    this.#app.bar.showTitle(this.#app.viewer.title);
  }

  /** What is still on its way is not waited for. */
  dispose(): void {
    ++this.#asked;
  }

  /** How the first case is shown at first. */
  #begin(link: Link): void {
    if (!link.view) {
      this.#app.actions.reset();
    }
    this.#app.follow(link);
  }

  #tellOfCase(): void {
    this.#app.bar.showTitle(this.#app.viewer.title);
    this.#app.offerLooks();
    this.#app.update();
  }

  /** What is not known of files of other programs. */
  #tellOfScale(): void {
    const { noScale } = texts().files;
    if (!this.#app.viewer.hasWorld) {
      this.#app.tell(noScale);
    } else if (this.#app.news === noScale) {
      this.#app.tell("");
    }
  }

  /** What is heard of a case on its way is said on the page, and in a headset. */
  #listener(coming: Omit<LoadingCase, "share">, asked: number): OpeningListener {
    const { loading, headset } = this.#app;
    return {
      cover: (cover) => loading.cover(cover),
      pictured: () => loading.pictured(),
      progress: (loaded, total) => {
        loading.progress(loaded, total);
        const bytes = total || coming.bytes;
        if (asked === this.#asked) {
          headset.loading.value = { ...coming, bytes, share: bytes > 0 ? Math.min(1, loaded / bytes) : 0 };
        }
      },
    };
  }
}
