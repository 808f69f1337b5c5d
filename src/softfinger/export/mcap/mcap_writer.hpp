#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "softfinger/export/mcap/crc32.hpp"
#include "softfinger/files/file_beside.hpp"
#include "softfinger/wire/byte_order.hpp"

namespace softfinger {

/// Writes an MCAP file (https://mcap.dev/spec) of ROS 2 messages: profile ros2, encoding cdr,
/// schemas ros2msg. Messages come in chunks of about a megabyte, not compressed, each with its CRC
/// and its index; a summary and statistics end the file. Nothing throws: ok() tells.
class McapWriter {
 public:
  using Bytes = std::span<const std::uint8_t>;

  McapWriter(FileBeside& file, std::string_view library);
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// A topic of messages of this type ("std_msgs/msg/String"), in the language of .msg files. All
  /// come before the first message.
  [[nodiscard]] std::uint16_t add_channel(std::string_view topic, std::string_view type,
                                          std::string_view schema);
  void add_metadata(std::string_view name, const std::map<std::string, std::string>& entries);
  /// `time`: ns since the start of the run.
  void write(std::uint16_t channel, std::uint64_t time, Bytes message);
  /// The last chunk, and what comes after all of them.
  void close();

  [[nodiscard]] bool ok() const { return ok_; }

 private:
  /// Of what lies between two offsets.
  struct Extent {
    std::uint64_t begin = 0, size = 0;
  };
  struct Times {
    std::uint64_t first = 0, last = 0;  ///< ns
    void add(std::uint64_t time, bool is_first);
  };
  using MessageIndex = std::vector<std::pair<std::uint64_t, std::uint64_t>>;  ///< time, offset

  void put(Bytes bytes);
  void put_record(std::uint8_t kind, ByteWriter& content);
  void end_chunk();
  void index_chunk(std::uint64_t begin, const Times& times, std::uint64_t records);
  void end_data();
  void put_group(std::uint8_t kind, Bytes records, ByteWriter& offsets);
  [[nodiscard]] ByteWriter statistics() const;

  FileBeside& file_;
  bool ok_ = true;
  std::uint64_t size_ = 0;  ///< bytes written
  Crc32 crc_;               ///< of them, or of the summary

  ByteWriter chunk_;  ///< the records of the next one
  Times chunk_times_;
  std::vector<MessageIndex> chunk_index_;  ///< of each channel
  std::uint64_t chunk_messages_ = 0;

  // For the summary: records as they are.
  ByteWriter schemas_, channels_, chunks_, metadata_;
  std::vector<std::uint64_t> counts_;  ///< messages of each channel
  std::uint32_t chunk_count_ = 0, metadata_count_ = 0;
  std::uint64_t message_count_ = 0;
  Times times_;
};

}  // namespace softfinger
