// A running rig, its gateway, and a browser that looks at it.
//   $GYROTWIN_BIN: the programs; $GYROTWIN_PAGE: the built page
import {spawn, execFileSync} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {chromium} from 'playwright-core';

const BIN = process.env.GYROTWIN_BIN;
const PATIENCE = 60000;  // [ms]

export class Lab {
  constructor(rig) {
    this.rig = rig;
    this.folder = mkdtempSync(join(tmpdir(), 'gyrotwin-page-'));
    process.env.GYROTWIN_KEYS = this.folder;
    this.daemons = new Map();
    this.errors = [];  // of the page's console
    this.run('key', 'new');
  }

  // A busy machine's pauses do not count as lost commands.
  get words() { return ['--rig', this.rig, '--set', 'loop.patience_s=10']; }

  run(program, ...words) {
    return execFileSync(join(BIN, `gyrotwin-${program}`), [...words, ...this.words], {encoding: 'utf8', stdio: 'pipe'});
  }

  start(program, ...words) {
    const child = spawn(join(BIN, `gyrotwin-${program}`), [...words, ...this.words], {stdio: 'ignore'});
    this.daemons.set(program, child);
  }

  kill(program, signal = 'SIGKILL') {
    const child = this.daemons.get(program);
    this.daemons.delete(program);
    return new Promise((resolve) => { child.once('exit', resolve); child.kill(signal); });
  }

  // Slowed down, so that a busy machine's pauses are short in the rig's time.
  async balance() {
    for (const daemon of ['integrator', 'controller', 'mirror']) this.start(daemon);
    this.startGateway();
    this.run('ctl', 'wait', 'ready', '--timeout', '30');
    this.run('ctl', 'speed', '0.25');
    this.run('ctl', 'arm');
    this.run('ctl', 'wait', 'balanced', '--timeout', '60');
  }

  startGateway() {
    this.start('gateway', '--page', process.env.GYROTWIN_PAGE, '--recordings', join(this.folder, 'recordings'));
  }

  address(role = 'operator') {
    return new RegExp(`^${role} +(\\S+)`, 'm').exec(this.run('gateway', '--urls'))[1];
  }

  async open({width = 1440, height = 900, colorScheme = 'dark', role = 'operator'} = {}) {
    this.browser ??= await chromium.launch({executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
      args: ['--no-sandbox', '--enable-unsafe-swiftshader', '--disable-background-networking', '--disable-quic', '--no-first-run']});
    const page = await this.browser.newPage({viewport: {width, height}, colorScheme});
    page.setDefaultTimeout(PATIENCE);
    page.on('console', (message) => { if (message.type() === 'error') this.errors.push(message.text()); });
    page.on('pageerror', (error) => this.errors.push(String(error)));
    await page.goto(this.address(role));
    return page;
  }

  async close() {
    await this.browser?.close();
    for (const program of [...this.daemons.keys()]) await this.kill(program, 'SIGTERM');
    rmSync(this.folder, {recursive: true, force: true});
  }
}

export const until = (page, holds, argument, timeout = PATIENCE) => page.waitForFunction(holds, argument, {timeout, polling: 100});
export const text = (page, selector) => page.locator(selector).innerText();
export const axe = readFileSync(new URL('node_modules/axe-core/axe.min.js', import.meta.url), 'utf8');
