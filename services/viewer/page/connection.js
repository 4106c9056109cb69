import {decode} from './packet.js';

const kFirstPause = 300;  // ms
const kLongestPause = 3000;

/** Keeps a stream of packets open, whatever happens to the viewer. Every new stream begins with the whole scene. */
export function connect(onPacket, onOnline) {
  let pause = kFirstPause;
  const open = () => {
    const socket = new WebSocket(`ws://${location.host}/stream`);
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      pause = kFirstPause;
      onOnline(true);
    };
    socket.onmessage = (message) => onPacket(decode(message.data));
    socket.onclose = () => {
      onOnline(false);
      setTimeout(open, pause);
      pause = Math.min(2 * pause, kLongestPause);
    };
  };
  open();
}
