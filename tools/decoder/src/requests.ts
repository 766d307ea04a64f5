// SPDX-License-Identifier: GPL-3.0-or-later
//
// Requests, and what people are told when they fail.

/** A host that cannot be reached, or that refuses: a title and, as the message, a sentence for people. */
export class Problem extends Error {
  /**
   * @param status      Of HTTP; 0: there was no answer.
   * @param limit       The limit of a service that a question went beyond, by its name.
   * @param retryAfter  Seconds after which the host wants to be asked again.
   */
  constructor(readonly title: string, message: string, readonly status = 0, readonly limit = '', readonly retryAfter = 0) {
    super(message);
    this.name = 'Problem';
  }
}

/** Where this code runs, for relative addresses; undefined in Node. */
export const here = (): string | undefined => (globalThis as { location?: { href: string } }).location?.href;

/**
 * The answer of a host. Throws the Problem of a host that cannot be reached, or of an answer that is none; and the reason of the
 * signal once that is aborted.
 */
export async function opened(address: string, init: RequestInit = {}): Promise<Response> {
  const response = await fetch(address, init).catch(() => {
    init.signal?.throwIfAborted();
    throw new Problem('The terrain cannot be reached', unreached(address));
  });
  await checkAnswer(response);
  return response;
}

function unreached(address: string): string {
  const page = here();
  if (page === undefined && !/^https?:/i.test(address)) {
    return `${address} is no address on a web host. A file of this machine is opened by openBytes(createReadStream(path)).`;
  }
  const url = new URL(address, page);
  if (page === undefined) return `${url.host} did not answer.`;
  return url.origin === new URL(page).origin ? 'The connection to the host broke, or there is none.'
    : `${url.host} did not answer, or does not let pages of other hosts read it ` +
      '(its answers need the header Access-Control-Allow-Origin).';
}

async function checkAnswer(response: Response): Promise<void> {
  if (response.ok) return;
  const { status } = response;
  const type = response.headers.get('Content-Type') ?? '';
  const retryAfter = Number(response.headers.get('Retry-After')) || 0;
  if (type.includes('json')) {
    const told = await response.json().catch(() => null) as
      { title?: string; detail?: string; limit?: string } | null;
    if (told?.detail !== undefined) {
      throw new Problem(told.title ?? `The host answered ${status}`, told.detail, status, told.limit ?? '', retryAfter);
    }
  }
  // A body that nobody reads would keep the connection.
  await response.body?.cancel().catch(() => undefined);
  const path = new URL(response.url).pathname;
  const said: Record<number, [string, string]> = {
    401: ['Not allowed', 'The host wants to know who asks.'],
    403: ['Not allowed', `The host does not give out ${path}.`],
    404: ['There is no such terrain', `The host has no ${path}. Look at the address for a slip.`],
  };
  const [title, message] = said[status] ?? [`The host answered ${status}`, `It could not give out ${path}.`];
  throw new Problem(title, message, status, '', retryAfter);
}

/** Tries of a host without a byte, after which it counts as gone. */
const mostTries = 4;
/** Milliseconds before the second try, and the most that a host is waited for. */
const firstPause = 250, longestPause = 20000;

/** The tries of a host that fails: few, with pauses between that double. */
export class Tries {
  private failed = 0;

  /** Something came: counting begins anew. */
  succeed(): void {
    this.failed = 0;
  }

  /**
   * Waits before the next try. Throws the failure where another try is none worth: it was one too many, the host refuses, or it wants
   * to be left alone for longer; and the reason of a signal that is aborted.
   * @param failure  Of a Problem, or of a body that broke
   */
  async next(failure: unknown, signal?: AbortSignal): Promise<void> {
    signal?.throwIfAborted();
    const problem = failure instanceof Problem ? failure
      : new Problem('The connection broke', 'The host stopped in the middle of its answer, and does not go on.');
    const { status, retryAfter } = problem;
    const mayPass = status === 0 || status === 429 || status >= 500;
    const wait = Math.max(firstPause * 2 ** this.failed, 1000 * retryAfter);
    if (!mayPass || ++this.failed >= mostTries || wait > longestPause) throw problem;
    await pause(wait, signal);
  }
}

/** Resolves after some time. Throws the reason of a signal that is aborted before. */
function pause(milliseconds: number, signal?: AbortSignal): Promise<void> {
  return new Promise((resolve, reject) => {
    const aborted = (): void => {
      clearTimeout(timer);
      reject(signal?.reason as Error);
    };
    const timer = setTimeout(() => {
      signal?.removeEventListener('abort', aborted);
      resolve();
    }, milliseconds);
    if (signal?.aborted === true) aborted();
    else signal?.addEventListener('abort', aborted, { once: true });
  });
}

/** The value of a promise, unless the signal is aborted before: then its reason is thrown. */
export async function until<T>(promise: Promise<T>, signal?: AbortSignal): Promise<T> {
  if (signal === undefined) return promise;
  let aborted = (): void => undefined;
  const abortion = new Promise<never>((_, reject) => {
    aborted = () => { reject(signal.reason as Error); };
    if (signal.aborted) aborted();
    signal.addEventListener('abort', aborted, { once: true });
  });
  try {
    return await Promise.race([promise, abortion]);
  } finally {
    signal.removeEventListener('abort', aborted);
  }
}
