// Texts that are not saved. They outlive the view that shows them and, in the storage of the browser's tab, a reload.

export interface Draft {
  text: string;
  saved: string; // what the file has
  etag: string; // of that
}

type Store = Pick<Storage, 'getItem' | 'setItem'>;

const item = 'robomill drafts';

function read(store: Store | null): [string, Draft][] {
  try {
    return JSON.parse(store?.getItem(item) ?? '[]') as [string, Draft][];
  } catch {
    return [];
  }
}

export class Drafts {
  private readonly kept: Map<string, Draft>;
  stored = true; // all of them

  /** `unsaved`: whether there is any, now and when that changes. */
  constructor(
    private readonly store: Store | null,
    private readonly unsaved: (some: boolean) => void,
  ) {
    this.kept = new Map(read(store));
    unsaved(this.kept.size > 0);
  }

  get(path: string): Draft | null {
    return this.kept.get(path) ?? null;
  }

  /** null: it is saved, or dropped. */
  put(path: string, draft: Draft | null): void {
    if (this.get(path) === draft) return;
    if (draft) this.kept.set(path, draft);
    else this.kept.delete(path);
    try {
      this.store?.setItem(item, JSON.stringify([...this.kept]));
      this.stored = this.store !== null;
    } catch {
      this.stored = false; // no room for them
    }
    this.unsaved(this.kept.size > 0);
  }
}

function tabStore(): Store | null {
  try {
    return window.sessionStorage;
  } catch {
    return null; // not in a browser, or not allowed
  }
}

function ask(event: BeforeUnloadEvent): void {
  event.preventDefault();
}

/** A page without drafts has no listener: a browser may keep it for the way back. */
function warn(some: boolean): void {
  if (typeof window === 'undefined') return;
  if (some) window.addEventListener('beforeunload', ask);
  else window.removeEventListener('beforeunload', ask);
}

export const drafts = new Drafts(tabStore(), warn);

/** Without a question where nothing is lost. */
export function reloadPage(): void {
  warn(!drafts.stored);
  window.location.reload();
}
