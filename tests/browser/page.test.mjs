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
  await is('RUNNING');
});
after(() => lab.close());

const lean = () => text(page, '#lean').then(parseFloat);
// The scene alone, without what lies over it.
const picture = () => page.locator('#view canvas').screenshot({style: '#view > :not(canvas) { visibility: hidden !important; }'});
const looks = async () => createHash('sha256').update(await picture()).digest('hex');

// Picture points that are blue or golden, the ring and the flywheels, as a string of marks.
async function coloured() {
  return page.evaluate(async (png) => {
    const image = new Image();
    image.src = `data:image/png;base64,${png}`;
    await image.decode();
    const context = Object.assign(document.createElement('canvas'), {width: image.width, height: image.height}).getContext('2d');
    context.drawImage(image, 0, 0);
    const {data} = context.getImageData(0, 0, image.width, image.height);
    const marks = [];
    for (let i = 0; i < data.length; i += 4) {
      marks.push(data[i + 2] > data[i] + 80 ? 'b' : data[i] > data[i + 2] + 60 ? 'g' : '.');
    }
    return marks.join('');
  }, (await picture()).toString('base64'));
}
const count = (marks, mark) => marks.split(mark).length - 1;

const is = (mode) => until(page, (name) => document.querySelector('#mode').textContent === name, mode);
async function pause() {
  await page.keyboard.press('Space');
  await is('PAUSED');
}
async function resume() {
  await page.keyboard.press('Space');
  await is('RUNNING');
}

test('the rig is named, and the platform is drawn', async () => {
  assert.equal(await text(page, '#rig'), 'prototype_b');
  // The words may be there before a slow machine has drawn anything.
  for (let tries = 0, ring = 0, wheels = 0; ring <= 300 || wheels <= 1000; ++tries) {
    assert.ok(tries < 30, `${ring} points of the ring, ${wheels} of flywheels`);
    const drawn = await coloured();
    [ring, wheels] = [count(drawn, 'b'), count(drawn, 'g')];
  }
});

test('the platform moves while time goes on, and stands still while it is paused', async () => {
  const first = await looks();
  for (let tries = 0; await looks() === first; ++tries) assert.ok(tries < 50, 'nothing moves');
  await pause();
  // What was on its way is drawn yet, and a slow machine may draw nothing between two looks.
  let before = await looks();
  for (let tries = 0, still = 0; still < 4; ++tries) {
    assert.ok(tries < 30, 'it moves although time stands still');
    const now = await looks();
    still = now === before ? still + 1 : 0;
    before = now;
  }
  await resume();
});

test('the platform is drawn as it leans', async () => {
  await page.uncheck('#ghost');
  await page.evaluate(() => document.activeElement.blur());
  await until(page, () => parseFloat(document.querySelector('#lean').textContent) < 0.3);
  await pause();
  const upright = await coloured();
  // Where a push meets what is left of the last one, it may leave little.
  for (let tries = 0; await lean() < 1; ++tries) {
    assert.ok(tries < 20, 'it never leans');
    await resume();
    await page.keyboard.press('p');
    await until(page, () => parseFloat(document.querySelector('#lean').textContent) > 2, null, 3000).catch(() => {});
    await pause();
  }
  const leaning = await coloured();
  let moved = 0;
  for (let i = 0; i < upright.length; ++i) if (upright[i] !== leaning[i]) ++moved;
  assert.ok(moved > 0.1 * (count(upright, 'b') + count(upright, 'g')), `${moved} points differ`);
  await resume();
  await page.check('#ghost');
  await page.evaluate(() => document.activeElement.blur());
});

test('a push with the key tilts the plant; the chart and the list show it', async () => {
  await until(page, () => parseFloat(document.querySelector('#lean').textContent) < 0.5);
  await page.keyboard.press('p');
  await until(page, () => parseFloat(document.querySelector('#lean').textContent) > 1);
  await until(page, () => [...document.querySelectorAll('.happenings li')].some((li) => /push of 5.00 N m s/.test(li.textContent) &&
    /ticks/.test(li.textContent)));
  await until(page, () => parseFloat(/[ ,]roll from \S+ ° to (\S+)/.exec(
    document.querySelector('#charts .plot').getAttribute('aria-label').replace('twin roll', ''))?.[1]) > 1);
});

// The README's picture, with $GYROTWIN_PICTURES.
test('the picture of a push', {skip: !process.env.GYROTWIN_PICTURES}, async () => {
  await page.keyboard.press('p');
  await new Promise((resolve) => setTimeout(resolve, 1500));
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
  await until(page, () => /N m s: .* N m for 20.0 ms/.test(document.querySelector('.pull:not([hidden])')?.textContent));
  await page.mouse.up();
  await until(page, (n) => [...document.querySelectorAll('.happenings li')].slice(0, -n).some((li) => /push of/.test(li.textContent)), before);
});

test('the chart under the cursor says what and when it was', async () => {
  const {x, y, width, height} = await page.locator('#charts .plot').first().boundingBox();
  await page.mouse.move(x + 0.9 * width, y + 0.5 * height);
  await until(page, () => /^at −\d/.test(document.querySelector('.reading-when').textContent) &&
    /\d/.test(document.querySelector('.reading-value').textContent));
  await page.mouse.move(5, 5);
  await until(page, () => document.querySelector('.reading-when').textContent === '');
});

test('dragging over a chart zooms into it, a double click brings it back', async () => {
  const {x, y, width, height} = await page.locator('#charts .plot').first().boundingBox();
  await page.mouse.move(x + 0.6 * width, y + 0.5 * height);
  await page.mouse.down();
  await page.mouse.move(x + 0.8 * width, y + 0.5 * height, {steps: 4});
  await page.mouse.up();
  await until(page, () => document.querySelector('#freeze').textContent === 'Live');
  await page.mouse.dblclick(x + 0.7 * width, y + 0.5 * height);
  await until(page, () => document.querySelector('#freeze').textContent === 'Hold');
});

test('held charts stay, live ones go on', async () => {
  await page.keyboard.press('h');
  await until(page, () => document.querySelector('#freeze').getAttribute('aria-pressed') === 'true');
  await page.keyboard.press('h');
  await until(page, () => document.querySelector('#freeze').getAttribute('aria-pressed') === 'false');
});

test('everything is reached with the keyboard, and the focus is seen', async () => {
  await pause();
  await resume();
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
  for (const button of ['Stop', 'Pause', 'Reset', 'Push', 'Hold', 'Events', 'Disturb', 'Daemons', 'Rig', 'Corner']) {
    assert.ok(reached.has(button), `${button} is not reached: ${[...reached]}`);
  }
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press('?');
  await until(page, () => document.querySelector('#help').open);
  await page.keyboard.press('Escape');
  await until(page, () => !document.querySelector('#help').open);
});

test('twin, margins, forecast and daemons are told in words', async () => {
  await until(page, () => /as the model says/.test(document.querySelector('.verdict').textContent));
  await until(page, () => /stands/.test(document.querySelector('#chip-forecast').textContent));
  const words = await page.locator('.gauge-word').allInnerTexts();
  assert.equal(words.length, 4);
  for (const word of words) assert.match(word, /fine|little left|none left/);
  await page.getByRole('button', {name: 'Daemons'}).click();
  await until(page, () => document.querySelectorAll('.daemon').length >= 3 && /µs|ms/.test(document.querySelector('.daemon-facts').textContent));
  await page.getByRole('button', {name: 'Events'}).click();
});

test('a disturbance is asked for, and answered', async () => {
  await page.getByRole('button', {name: 'Disturb', exact: true}).click();
  await page.getByLabel('Disturbance or fault').selectOption({label: 'Fault: drives weak'});
  await page.getByRole('button', {name: 'Cause it'}).click();
  await until(page, () => [...document.querySelectorAll('.happenings li')].some((li) =>
    /drives weak, 50 % left/.test(li.textContent) && /number/.test(li.textContent)));
  await page.getByRole('button', {name: 'End all'}).click();
  await page.getByRole('button', {name: 'Events'}).click();
});

test('a recording begins and ends, and can be fetched', async () => {
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press('w');
  await until(page, () => /● .*\.lcm/.test(document.querySelector('#recording').textContent));
  await page.keyboard.press('w');
  await until(page, () => /^[^●]*\.lcm/.test(document.querySelector('#recording').textContent));
  await until(page, () => document.querySelector('.files a') !== null);
  const {name, bytes} = await page.evaluate(async () => {
    const link = document.querySelector('.files a');
    return {name: link.download, bytes: new Uint8Array(await (await fetch(link.href)).arrayBuffer()).length};
  });
  assert.match(name, /^prototype_b-.*\.lcm$/);
  assert.ok(bytes > 10000);
});

test('after a fall the page says what to do, and it is done with two keys', async () => {
  lab.run('disturb', 'step', '--roll', '2000');
  await is('FALLEN');
  await until(page, () => /reset, then arm/.test(document.querySelector('#call:not([hidden])')?.textContent));
  await page.keyboard.press('r');
  await is('HELD');
  await page.keyboard.press('a');
  await until(page, () => document.querySelector('#mode').textContent === 'RUNNING' && document.querySelector('#call').hidden);
});

test('stop is one key', async () => {
  await page.keyboard.press('d');
  await is('SAFE STOP');
  await page.keyboard.press('r');
  await is('HELD');
  await page.keyboard.press('a');
  await is('RUNNING');
});

test('the colours chosen are kept', async () => {
  const theme = () => page.evaluate(() => document.documentElement.dataset.theme);
  const first = await theme();
  await page.click('#theme');
  assert.notEqual(await theme(), first);
  await page.reload();
  await is('RUNNING');
  assert.notEqual(await theme(), first);
  await page.click('#theme');
});

test('on a phone stop is in sight whatever the tab, and nothing is cut off', async () => {
  const phone = await lab.open({width: 390, height: 844});
  await until(phone, () => document.querySelector('#mode').textContent === 'RUNNING');
  for (const tab of ['charts', 'state', 'log', 'control']) {
    await phone.click(`#tabs [data-tab=${tab}]`);
    const {stop, wide} = await phone.evaluate(() => {
      const {left, right, top, bottom} = document.querySelector('.stop').getBoundingClientRect();
      return {
        stop: left >= 0 && right <= innerWidth && top >= 0 && bottom <= innerHeight && bottom - top >= 44,
        wide: document.documentElement.scrollWidth > innerWidth,
      };
    });
    assert.ok(stop, `stop is out of sight with ${tab}`);
    assert.ok(!wide, `${tab} is wider than the phone`);
  }
  await phone.close();
});

for (const [width, height, colorScheme] of [[1440, 900, 'dark'], [1024, 768, 'light'], [390, 844, 'light']]) {
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
  assert.equal(await other.locator('#acts button:enabled, .push button:enabled, [data-pane] button:enabled').count(), 0);
  assert.match(await text(other, '.hint'), /looking on/);
  await other.close();
});

test('an owner that falls silent is told, and its data marked old', async () => {
  await page.evaluate(() => document.activeElement.blur());
  lab.daemons.get('integrator').kill('SIGSTOP');
  await until(page, () => !document.querySelector('#banner').hidden && /No data for/.test(document.querySelector('#banner').textContent));
  assert.equal(await text(page, '#mode'), 'NO DATA');
  assert.match(await text(page, '#call'), /No data for \d+ s/);
  lab.daemons.get('integrator').kill('SIGCONT');
  await until(page, () => document.querySelector('#banner').hidden);
});

test('a page that was held up says by how much it is behind, until it is not', async () => {
  await page.evaluate(() => {
    globalThis.banners = [];
    const banner = document.querySelector('#banner');
    new MutationObserver(() => globalThis.banners.push(banner.hidden ? '' : banner.textContent))
      .observe(banner, {attributes: true, childList: true, characterData: true, subtree: true});
    // With a question on its way.
    const {send} = WebSocket.prototype;
    WebSocket.prototype.send = function (data) {
      send.call(this, data);
      if (!/"delay /.test(data)) return;
      WebSocket.prototype.send = send;
      const end = performance.now() + 4000;
      while (performance.now() < end);
    };
  });
  await until(page, () => globalThis.banners.some((text) => /too slow: what is shown comes \d+ s late/.test(text)));
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
