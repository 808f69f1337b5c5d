// Reads MCAP files by the format's own library and prints what is in them as JSON, numbers to the last bit:
//
//     node read_mcap.mjs FILE...
//
// Fails where a checksum is missing or wrong, where the file read from front to end has other messages than read by its
// index, and where a message does not fit its schema.
import assert from "node:assert";
import { open, readFile } from "node:fs/promises";

import { crc32 } from "@foxglove/crc";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";

const MAGIC_AND_FOOTER = 8 + 9 + 20;
const DATA_END = 9 + 4;

function readable(file, size) {
  return {
    size: async () => BigInt(size),
    read: async (offset, length) => {
      const buffer = new Uint8Array(Number(length));
      const { bytesRead } = await file.read(buffer, 0, buffer.length, Number(offset));
      assert.equal(bytesRead, buffer.length);
      return buffer;
    },
  };
}

/** How many messages there are from front to end. */
function countByStream(bytes) {
  const reader = new McapStreamReader({ validateCrcs: true });
  reader.append(bytes);
  let messages = 0;
  let record;
  while ((record = reader.nextRecord()) !== undefined) {
    if (record.type === "Message") messages += 1;
    if (record.type === "Chunk") assert.notEqual(record.uncompressedCrc, 0);
    if (record.type === "DataEnd") assert.notEqual(record.dataSectionCrc, 0);
    if (record.type === "Footer") assert.notEqual(record.summaryCrc, 0);
  }
  assert(reader.done());
  return messages;
}

async function read(path) {
  const bytes = await readFile(path);
  const file = await open(path);
  try {
    const reader = await McapIndexedReader.Initialize({ readable: readable(file, bytes.length) });
    const summary = Number(bytes.readBigUInt64LE(bytes.length - MAGIC_AND_FOOTER + 9));
    assert.equal(reader.dataSectionCrc, crc32(bytes.subarray(0, summary - DATA_END)));

    const readers = new Map();
    const channels = {};
    for (const channel of reader.channelsById.values()) {
      const schema = reader.schemasById.get(channel.schemaId);
      assert.equal(schema.encoding, "ros2msg");
      assert.equal(channel.messageEncoding, "cdr");
      const definitions = parse(new TextDecoder().decode(schema.data), { ros2: true });
      readers.set(channel.id, new MessageReader(definitions));
      channels[channel.topic] = { schema: schema.name, messages: [] };
    }
    let count = 0;
    for await (const message of reader.readMessages()) {
      count += 1;
      const value = readers.get(message.channelId).readMessage(message.data);
      const { topic } = reader.channelsById.get(message.channelId);
      channels[topic].messages.push({ time: message.logTime, value });
    }
    assert.equal(countByStream(bytes), count);
    assert.equal(reader.statistics.messageCount, BigInt(count));
    for (const channel of reader.channelsById.values()) {
      const counted = reader.statistics.channelMessageCounts.get(channel.id);
      assert.equal(counted, BigInt(channels[channel.topic].messages.length));
    }
    let within = 0;
    for await (const _ of reader.readMessages({ topics: ["/wrench"], startTime: 100_000_000n, endTime: 200_000_000n })) {
      within += 1;
    }
    const metadata = {};
    for await (const record of reader.readMetadata()) metadata[record.name] = Object.fromEntries(record.metadata);
    return {
      profile: reader.header.profile,
      library: reader.header.library,
      chunks: reader.statistics.chunkCount,
      wrenches_within: within,
      metadata,
      channels,
    };
  } finally {
    await file.close();
  }
}

function plain(_, value) {
  if (typeof value === "bigint") return Number(value);
  if (value instanceof Float64Array) return Array.from(value);
  if (value instanceof Uint8Array) return Buffer.from(value).toString("hex");
  return typeof value === "number" && !Number.isFinite(value) ? String(value) : value;
}

const files = await Promise.all(process.argv.slice(2).map(read));
console.log(JSON.stringify(files, plain));
