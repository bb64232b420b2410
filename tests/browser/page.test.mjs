// The page on a running prototype_b: it shows what happens, pushes, comes back, and says when it is old.
import assert from 'node:assert/strict';
import {createHash} from 'node:crypto';
import {after, before, test} from 'node:test';

import {Lab, axe, text, until} from './lab.mjs';

const lab = new Lab('prototype_b');
let page;
before(async () => {
  await lab.balance();
  page = await lab.open();
  await until(page, () => document.querySelector('#mode').textContent === 'RUNNING');
});
after(() => lab.close());

const lean = () => text(page, '#lean').then(parseFloat);
const looks = async () => createHash('sha256').update(await page.locator('#view canvas').screenshot()).digest('hex');

test('the rig is named, and the platform is drawn and moves', async () => {
  assert.equal(await text(page, '#rig'), 'prototype_b');
  const drawn = await page.evaluate(async () => {
    await new Promise((resolve) => requestAnimationFrame(resolve));
    const {width, height} = document.querySelector('#view canvas');
    return width * height;
  });
  assert.ok(drawn > 10000);
  const first = await looks();
  for (let tries = 0; await looks() === first; ++tries) assert.ok(tries < 50, 'nothing moves');
});

test('a push with the key tilts the plant; the chart and the list show it', async () => {
  await until(page, () => parseFloat(document.querySelector('#lean').textContent) < 0.5);
  await page.keyboard.press('p');
  await until(page, () => parseFloat(document.querySelector('#lean').textContent) > 1);
  await until(page, () => [...document.querySelectorAll('.happenings li')].some((li) => /push of 5.00 N m s/.test(li.textContent) &&
    /ticks/.test(li.textContent)));
  await until(page, () => parseFloat(/Tilt: roll from \S+ ° to (\S+)/.exec(
    document.querySelector('#charts .plot').getAttribute('aria-label'))?.[1]) > 1);
});

// The README's picture, with $GYROTWIN_PICTURES.
test('the picture of a push', {skip: !process.env.GYROTWIN_PICTURES}, async () => {
  await until(page, () => parseFloat(document.querySelector('#lean').textContent) < 0.5);
  await page.keyboard.press('p');
  await until(page, () => parseFloat(document.querySelector('#lean').textContent) > 1);
  await new Promise((resolve) => setTimeout(resolve, 600));
  await page.screenshot({path: `${process.env.GYROTWIN_PICTURES}/prototype_b.png`});
});

test('pulling the platform pushes it', async () => {
  await until(page, () => parseFloat(document.querySelector('#lean').textContent) < 0.5);
  const before = await page.locator('.happenings li').count();
  const {x, y, width, height} = await page.locator('#view canvas').boundingBox();
  // Where something of the platform is under the mouse.
  for (let dy = 0.3; dy < 0.75; dy += 0.03) {
    await page.mouse.move(x + 0.5 * width, y + dy * height);
    if (await page.evaluate(() => document.querySelector('#view canvas').style.cursor === 'grab')) break;
  }
  await page.mouse.down();
  await page.mouse.move(x + 0.62 * width, y + 0.5 * height, {steps: 4});
  await page.mouse.up();
  await until(page, (n) => [...document.querySelectorAll('.happenings li')].slice(0, -n).some((li) => /push of/.test(li.textContent)), before);
});

test('held charts stay, live ones go on', async () => {
  await page.keyboard.press('h');
  await until(page, () => document.querySelector('#freeze').getAttribute('aria-pressed') === 'true');
  await page.keyboard.press('h');
  await until(page, () => document.querySelector('#freeze').getAttribute('aria-pressed') === 'false');
});

test('a recording is made, and can be fetched', async () => {
  await page.getByRole('button', {name: 'Record', exact: true}).click();
  await until(page, () => /● prototype_b.*\.lcm, [^0]/.test(document.body.textContent) || /● prototype_b.*, 0\.[1-9]/.test(document.body.textContent));
  await page.getByRole('button', {name: 'End recording'}).click();
  await until(page, () => /prototype_b-.*\.lcm \d/.test(document.querySelector('.files').textContent));
  const [download] = await Promise.all([page.waitForEvent('download'), page.locator('.files a').first().click()]);
  assert.match(download.suggestedFilename(), /^prototype_b-.*\.lcm$/);
});

test('everything is reached with the keyboard, and the focus is seen', async () => {
  await page.keyboard.press('Space');
  await until(page, () => document.querySelector('#mode').textContent === 'PAUSED');
  await page.keyboard.press('Space');
  await until(page, () => document.querySelector('#mode').textContent === 'RUNNING');
  await page.evaluate(() => document.activeElement.blur());
  const reached = new Set();
  for (let i = 0; i < 60; ++i) {
    await page.keyboard.press('Tab');
    const name = await page.evaluate(() => {
      const is = document.activeElement;
      if (is === document.body) return null;
      const ring = getComputedStyle(is).outlineStyle;
      return {name: is.textContent.trim().slice(0, 20) || is.getAttribute('aria-label') || is.id, ring};
    });
    if (!name) continue;
    assert.notEqual(name.ring, 'none', `${name.name} has the focus, and nothing shows it`);
    reached.add(name.name);
  }
  for (const button of ['Stop', 'Pause', 'Reset', 'Push', 'Cause it', 'Record', 'Hold']) assert.ok(reached.has(button), `${button} is not reached: ${[...reached]}`);
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press('?');
  await until(page, () => document.querySelector('#help').open);
  await page.keyboard.press('Escape');
  await until(page, () => !document.querySelector('#help').open);
});

for (const [width, height, colorScheme] of [[1440, 900, 'dark'], [390, 844, 'light']]) {
  test(`axe finds nothing serious at ${width} px, ${colorScheme}`, async () => {
    const other = await lab.open({width, height, colorScheme});
    await until(other, () => document.querySelector('#mode').textContent === 'RUNNING');
    await other.evaluate(axe);
    const {violations} = await other.evaluate(() => globalThis.axe.run());
    const grave = violations.filter(({impact}) => impact === 'serious' || impact === 'critical');
    assert.deepEqual(grave.map(({id, nodes}) => `${id}: ${nodes.map((n) => n.html.slice(0, 120)).join(' ')}`), []);
    await other.close();
  });
}

test('an observer sees all and can do nothing', async () => {
  const other = await lab.open({role: 'observer'});
  await until(other, () => document.querySelector('#mode').textContent === 'RUNNING');
  assert.equal(await other.locator('#side button:enabled').count(), 0);
  assert.match(await text(other, '.hint'), /looking on/);
  await other.close();
});

test('an owner that falls silent is told, and its data marked old', async () => {
  await page.evaluate(() => document.activeElement.blur());
  lab.daemons.get('integrator').kill('SIGSTOP');
  await until(page, () => !document.querySelector('#banner').hidden && /No data for/.test(document.querySelector('#banner').textContent));
  assert.equal(await text(page, '#mode'), 'NO DATA');
  lab.daemons.get('integrator').kill('SIGCONT');
  await until(page, () => document.querySelector('#banner').hidden);
});

test('a gateway that restarts is found again', async () => {
  const quiet = lab.errors.length;
  await lab.kill('gateway');
  await until(page, () => /connection to the gateway is lost/.test(document.querySelector('#banner').textContent));
  lab.startGateway();
  await until(page, () => document.querySelector('#banner').hidden);
  lab.errors.splice(quiet);  // Chromium's own, for connections that were refused
});

test('nothing was written to the console as an error', () => assert.deepEqual(lab.errors, []));
