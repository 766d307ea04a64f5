// SPDX-License-Identifier: GPL-3.0-or-later
//
// The page where no terrain was named.
import type { Boot } from './messages';
import { part } from './page';

/** Asks for the address of a stream or for a file. `start` begins the page with what was chosen. */
export function welcome(boot: Boot, start: () => void): void {
  const box = part('welcome');
  box.hidden = false;
  part('card').hidden = part('tools').hidden = true;
  const form = box.querySelector('form')!;
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    const stream = String(new FormData(form).get('stream')).trim();
    if (stream !== '') location.search = `?${new URLSearchParams({ stream })}`;
  });
  let isOpen = false;
  const openFile = (file: File | undefined): void => {
    if (file === undefined || isOpen) return;
    isOpen = true;
    box.hidden = true;
    part('card').hidden = part('tools').hidden = false;
    boot.source = { kind: 'stream', url: URL.createObjectURL(file), name: file.name };
    boot.open(boot.source);
    start();
  };
  box.querySelector<HTMLInputElement>('input[type=file]')!.addEventListener('change', (event) => {
    openFile((event.target as HTMLInputElement).files?.[0]);
  });
  addEventListener('dragover', (event) => { event.preventDefault(); });
  addEventListener('drop', (event) => {
    event.preventDefault();
    openFile(event.dataTransfer?.files[0]);
  });
}
