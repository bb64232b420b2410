// Waiting for what a gateway says, with Foxglove's own client and decoder.
import foxglove from '@foxglove/ws-protocol';
import rosmsg from '@foxglove/rosmsg';
import serialization from '@foxglove/rosmsg2-serialization';
import {WebSocket} from 'ws';

const PATIENCE = 20000;  // [ms]

export class Rig {
  constructor(url, subprotocol = 'foxglove.websocket.v1', options = {}) {
    this.socket = new WebSocket(url, [subprotocol], options);
    this.client = new foxglove.FoxgloveClient({ws: this.socket});
    this.heard = [];    // {kind, ...}
    this.waiting = [];  // {holds, resolve}
    this.channels = new Map();
    this.subscriptions = new Map();
    for (const kind of ['serverInfo', 'status', 'parameterValues', 'time']) {
      this.client.on(kind, (value) => this.hear({kind, value}));
    }
    this.client.on('error', (error) => this.hear({kind: 'error', value: error}));
    this.client.on('close', (event) => this.hear({kind: 'close', value: event}));
    this.client.on('advertise', (list) => {
      for (const channel of list) {
        const definition = rosmsg.parse(channel.schema, {ros2: true});
        this.channels.set(channel.topic, {...channel, definition,
          reader: new serialization.MessageReader(definition)});
      }
      this.hear({kind: 'advertise', value: list});
    });
    this.client.on('message', ({subscriptionId, timestamp, data}) => {
      const channel = this.subscriptions.get(subscriptionId);
      this.hear({kind: 'message', topic: channel.topic, timestamp, size: data.byteLength,
        value: channel.reader.readMessage(data)});
    });
  }

  hear(event) {
    this.heard.push(event);
    this.waiting = this.waiting.filter(({holds, resolve}) => !holds(event) || resolve(event));
  }

  // The first event, heard already or to come, of which `holds` is true.
  until(what, holds) {
    const known = this.heard.find(holds);
    if (known) return Promise.resolve(known);
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => reject(new Error(`waited in vain for ${what}`)), PATIENCE);
      this.waiting.push({holds, resolve: (event) => { clearTimeout(timer); resolve(event); }});
    });
  }

  message(topic, holds = () => true) {
    return this.until(topic, (e) => e.kind === 'message' && e.topic === topic && holds(e.value));
  }

  subscribe(topic) {
    const id = this.client.subscribe(this.channels.get(topic).id);
    this.subscriptions.set(id, this.channels.get(topic));
    return id;
  }

  // Publishes requests under one name. @return a function that sends one
  asks(topic) {
    const id = this.client.advertise({topic, encoding: 'json', schemaName: 'request'});
    return (request) => this.client.sendMessage(id, new TextEncoder().encode(
      typeof request === 'string' ? request : JSON.stringify(request)));
  }

  close() {
    this.client.close();
  }
}
