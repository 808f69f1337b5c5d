#include "softfinger/export/mcap/mcap_writer.hpp"

#include <algorithm>
#include <array>

namespace softfinger {
namespace {

// Opcodes of records.
constexpr std::uint8_t kHeader = 0x01, kFooter = 0x02, kSchema = 0x03, kChannel = 0x04,
                       kMessage = 0x05, kChunk = 0x06, kMessageIndex = 0x07, kChunkIndex = 0x08,
                       kStatistics = 0x0B, kMetadata = 0x0C, kMetadataIndex = 0x0D,
                       kSummaryOffset = 0x0E, kDataEnd = 0x0F;
constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
constexpr std::size_t kChunkSize = std::size_t{1} << 20;  ///< bytes

McapWriter::Bytes as_bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

void put_text(ByteWriter& to, std::string_view text) {
  to.u32(static_cast<std::uint32_t>(text.size()));
  to.append(as_bytes(text));
}

void put_map(ByteWriter& to, const std::map<std::string, std::string>& entries) {
  ByteWriter content;
  for (const auto& [key, value] : entries) {
    put_text(content, key);
    put_text(content, value);
  }
  to.u32(static_cast<std::uint32_t>(content.bytes().size()));
  to.append(content.bytes());
}

void put_head(ByteWriter& to, std::uint8_t kind, std::uint64_t size) {
  to.u8(kind);
  to.u64(size);
}

void append_record(ByteWriter& to, std::uint8_t kind, ByteWriter& content) {
  put_head(to, kind, content.bytes().size());
  to.append(content.bytes());
}

}  // namespace

void McapWriter::Times::add(std::uint64_t time, bool is_first) {
  first = is_first ? time : std::min(first, time);
  last = is_first ? time : std::max(last, time);
}

McapWriter::McapWriter(FileBeside& file, std::string_view library) : file_(file) {
  put(kMagic);
  ByteWriter header;
  put_text(header, "ros2");
  put_text(header, library);
  put_record(kHeader, header);
}

void McapWriter::put(Bytes bytes) {
  ok_ = ok_ && file_.write(bytes.data(), bytes.size(), size_);
  size_ += bytes.size();
  crc_.add(bytes);
}

void McapWriter::put_record(std::uint8_t kind, ByteWriter& content) {
  ByteWriter head;
  put_head(head, kind, content.bytes().size());
  put(head.bytes());
  put(content.bytes());
}

std::uint16_t McapWriter::add_channel(std::string_view topic, std::string_view type,
                                      std::string_view text) {
  const auto id = static_cast<std::uint16_t>(counts_.size() + 1);
  ByteWriter schema;
  schema.u16(id);
  put_text(schema, type);
  put_text(schema, "ros2msg");
  put_text(schema, text);
  put_record(kSchema, schema);
  append_record(schemas_, kSchema, schema);

  ByteWriter channel;
  channel.u16(id);
  channel.u16(id);
  put_text(channel, topic);
  put_text(channel, "cdr");
  put_map(channel, {{"offered_qos_profiles", ""}});  // the profile wants it
  put_record(kChannel, channel);
  append_record(channels_, kChannel, channel);

  counts_.push_back(0);
  chunk_index_.emplace_back();
  return id;
}

void McapWriter::add_metadata(std::string_view name,
                              const std::map<std::string, std::string>& entries) {
  const std::uint64_t begin = size_;
  ByteWriter metadata;
  put_text(metadata, name);
  put_map(metadata, entries);
  put_record(kMetadata, metadata);
  ++metadata_count_;

  ByteWriter index;
  index.u64(begin);
  index.u64(size_ - begin);
  put_text(index, name);
  append_record(metadata_, kMetadataIndex, index);
}

void McapWriter::write(std::uint16_t channel, std::uint64_t time, Bytes message) {
  std::uint64_t& count = counts_[channel - 1U];
  chunk_index_[channel - 1U].emplace_back(time, chunk_.bytes().size());
  put_head(chunk_, kMessage, 22 + message.size());
  chunk_.u16(channel);
  chunk_.u32(static_cast<std::uint32_t>(count++));
  chunk_.u64(time);  // logged
  chunk_.u64(time);  // published
  chunk_.append(message);
  chunk_times_.add(time, chunk_messages_++ == 0);
  times_.add(time, message_count_++ == 0);
  if (chunk_.bytes().size() >= kChunkSize) end_chunk();
}

void McapWriter::end_chunk() {
  if (chunk_messages_ == 0) return;
  const std::vector<std::uint8_t>& records = chunk_.bytes();
  const std::uint64_t begin = size_;
  ByteWriter front;
  front.u64(chunk_times_.first);
  front.u64(chunk_times_.last);
  front.u64(records.size());
  front.u32(crc32_of(records));
  put_text(front, "");  // compression
  front.u64(records.size());
  ByteWriter head;
  put_head(head, kChunk, front.bytes().size() + records.size());
  put(head.bytes());
  put(front.bytes());
  put(records);
  index_chunk(begin, chunk_times_, records.size());
  ++chunk_count_;
  chunk_messages_ = 0;
  chunk_.bytes().clear();
}

void McapWriter::index_chunk(std::uint64_t begin, const Times& times, std::uint64_t records) {
  const std::uint64_t end = size_;
  ByteWriter offsets;
  for (std::size_t i = 0; i < chunk_index_.size(); ++i) {
    MessageIndex& messages = chunk_index_[i];
    if (messages.empty()) continue;
    const auto id = static_cast<std::uint16_t>(i + 1);
    offsets.u16(id);
    offsets.u64(size_);
    ByteWriter index;
    index.u16(id);
    index.u32(static_cast<std::uint32_t>(16 * messages.size()));
    for (const auto& [time, offset] : messages) {
      index.u64(time);
      index.u64(offset);
    }
    put_record(kMessageIndex, index);
    messages.clear();
  }
  ByteWriter index;
  index.u64(times.first);
  index.u64(times.last);
  index.u64(begin);
  index.u64(end - begin);
  index.u32(static_cast<std::uint32_t>(offsets.bytes().size()));
  index.append(offsets.bytes());
  index.u64(size_ - end);
  put_text(index, "");
  index.u64(records);
  index.u64(records);
  append_record(chunks_, kChunkIndex, index);
}

void McapWriter::end_data() {
  end_chunk();
  ByteWriter end;
  end.u32(crc_.value());
  put_record(kDataEnd, end);
}

ByteWriter McapWriter::statistics() const {
  ByteWriter content;
  content.u64(message_count_);
  content.u16(static_cast<std::uint16_t>(counts_.size()));  // schemas
  content.u32(static_cast<std::uint32_t>(counts_.size()));  // channels
  content.u32(0);                                           // attachments
  content.u32(metadata_count_);
  content.u32(chunk_count_);
  content.u64(times_.first);
  content.u64(times_.last);
  content.u32(static_cast<std::uint32_t>(10 * counts_.size()));
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    content.u16(static_cast<std::uint16_t>(i + 1));
    content.u64(counts_[i]);
  }
  ByteWriter record;
  append_record(record, kStatistics, content);
  return record;
}

/// Records of one kind in the summary, and where they are.
void McapWriter::put_group(std::uint8_t kind, Bytes records, ByteWriter& offsets) {
  if (records.empty()) return;
  ByteWriter offset;
  offset.u8(kind);
  offset.u64(size_);
  offset.u64(records.size());
  append_record(offsets, kSummaryOffset, offset);
  put(records);
}

void McapWriter::close() {
  end_data();
  const std::uint64_t summary = size_;
  crc_ = {};
  ByteWriter offsets;
  put_group(kSchema, schemas_.bytes(), offsets);
  put_group(kChannel, channels_.bytes(), offsets);
  put_group(kStatistics, statistics().bytes(), offsets);
  put_group(kChunkIndex, chunks_.bytes(), offsets);
  put_group(kMetadataIndex, metadata_.bytes(), offsets);
  const std::uint64_t summary_offsets = size_;
  put(offsets.bytes());

  // The footer's CRC covers what stands before it there.
  ByteWriter footer;
  put_head(footer, kFooter, 20);
  footer.u64(summary);
  footer.u64(summary_offsets);
  put(footer.bytes());
  ByteWriter end;
  end.u32(crc_.value());
  end.append(kMagic);
  put(end.bytes());
}

}  // namespace softfinger
