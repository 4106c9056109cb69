// Binary messages of the viewer: services/viewer/packet.hpp describes them.

const kElements = {
  f32: Float32Array, u32: Uint32Array, i32: Int32Array, u16: Uint16Array, i8: Int8Array, u8: Uint8Array,
};

/** The head's fields, with the arrays under their names. The arrays are views of the buffer. */
export function decode(buffer) {
  const headSize = new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, headSize)));
  let offset = 4 + headSize;
  for (const [name, element, count] of head.arrays) {
    head[name] = new kElements[element](buffer, offset, count);
    offset += Math.ceil(head[name].byteLength / 4) * 4;
  }
  delete head.arrays;
  return head;
}
