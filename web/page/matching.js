// Matching of pairs, one at a time: of the requests that come in meanwhile, the latest is kept.

import * as library from "./library.js";

export class Matching {
  /**
   * @param {{begin: () => void, news: (news: {device?: string, step?: string, share?: number}) => void,
   *   done: (result: object) => void, failed: (error: Error) => void}} on calls on the way; `done` and `failed` are not called for what
   *   is obsolete
   */
  constructor(on) {
    this.on = on;
    this.busy = false;
  }

  /** @param {{left: ImageData, right: ImageData, task: object}} work */
  async match(work) {
    this.next = work;
    if (this.busy) {
      if (!this.awaited) this.on.begin();
      return;
    }
    this.occupied(true);
    while (this.next) {
      const work = (this.awaited = this.next);
      this.next = undefined;
      const isWanted = () => this.awaited === work;
      this.on.begin();
      try {
        const result = await library.match(work, (news) => {
          if (news.device || isWanted()) this.on.news(news);
        });
        if (isWanted() && !this.next) this.on.done(result);
      } catch (error) {
        if (isWanted() && !this.next) this.on.failed(error);
      }
    }
    this.occupied(false);
  }

  /** Makes what is being matched, and what waits, obsolete. */
  forget() {
    this.awaited = this.next = undefined;
  }

  /** Ends what is being matched; it ends at its next wait for the GPU, and nothing is told of it. */
  cancel() {
    this.forget();
    library.cancel();
  }

  occupied(now) {
    this.busy = now;
    document.body.ariaBusy = now;
  }
}
