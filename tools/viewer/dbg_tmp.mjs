import { chromium } from 'playwright-core';
const browser = await chromium.launch({ executablePath: '/usr/bin/chromium', args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'] });
const page = await browser.newPage({ viewport: { width: 1100, height: 720 } });
await page.goto(process.argv[2]);
await page.waitForFunction(() => performance.getEntriesByName('ptin-settled').length > 0, null, { timeout: 120000 });
await page.waitForTimeout(1500);
console.log(await page.evaluate(() => {
  const { frame, view, status, relief } = ptinViewer;
  const [w, s, e, n] = frame.bounds; const N = 64;
  const seen = view.seenWindows(frame, status.certified);
  const lines = [];
  for (let j = N - 1; j >= 0; --j) { let l = ''; for (let i = 0; i < N; ++i) {
    const win = [w + (e - w) * i / N, s + (n - s) * j / N, w + (e - w) * (i + 1) / N, s + (n - s) * (j + 1) / N];
    const mx = (win[0] + win[2]) / 2, my = (win[1] + win[3]) / 2;
    const er = Math.min(...status.certified.filter((p) => p.window[0] <= mx && p.window[2] >= mx && p.window[1] <= my && p.window[3] >= my).map((p) => p.error));
    l += seen(win) ? (er > 50 ? '#' : 'o') : er > 50 ? '.' : '-'; } lines.push(l); }
  return lines.join('\n') + '\n' + JSON.stringify(status.certified) + '\n' + JSON.stringify(view.current) + JSON.stringify(view.camera.position);
}));
await browser.close();
