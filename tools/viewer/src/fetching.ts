// SPDX-License-Identifier: GPL-3.0-or-later
//
// Requests, and what people are told when they fail.

/** A failure as a title and a sentence for people. */
export class Problem extends Error {
  /**
   * @param limit       The limit of a service that a question went beyond, by its name.
   * @param retryAfter  Seconds after which the service wants to be asked again.
   */
  constructor(readonly title: string, message: string, readonly status = 0, readonly limit = '', readonly retryAfter = 0) {
    super(message);
    this.name = 'Problem';
  }
}

/** What a host answers. Throws the Problem of a host that cannot be reached, or of an answer that is none. */
export async function opened(address: string, init: RequestInit = {}): Promise<Response> {
  const response = await fetch(address, init).catch(() => {
    const other = new URL(address, self.location.href).origin !== self.location.origin;
    throw new Problem(
      'The terrain cannot be reached',
      other
        ? `${new URL(address, self.location.href).host} did not answer, or does not let pages of other hosts read it ` +
          '(its answers need the header Access-Control-Allow-Origin).'
        : 'The connection to the host broke, or there is none.');
  });
  await checkAnswer(response);
  return response;
}

/** A module of the viewer, which lies beside the page. */
export async function moduleAt(folder: string, name: string): Promise<WebAssembly.Module> {
  const fetched = await fetch(new URL(name, folder)).catch(() => null);
  if (fetched === null) {
    throw new Problem('The viewer cannot be reached', `A part of it (${name}) did not come: the connection to the host broke, or there is none.`);
  }
  if (!fetched.ok) throw new Problem('The viewer is not whole', `A part of it (${name}) does not lie beside it.`);
  return WebAssembly.compile(await fetched.arrayBuffer());
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
  const path = new URL(response.url).pathname;
  const said: Record<number, [string, string]> = {
    401: ['Not allowed', 'The host wants to know who asks.'],
    403: ['Not allowed', `The host does not give out ${path}.`],
    404: ['There is no such terrain', `The host has no ${path}. Look at the address for a slip.`],
  };
  const [title, message] = said[status] ?? [`The host answered ${status}`, `It could not give out ${path}.`];
  throw new Problem(title, message, status, '', retryAfter);
}
