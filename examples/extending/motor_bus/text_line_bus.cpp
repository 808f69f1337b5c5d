#include "text_line_bus.hpp"

#include <charconv>
#include <cstring>
#include <string_view>

namespace softfinger {

bool read_text_line(std::string_view line, char letter, std::span<std::int32_t> numbers) {
  if (line.empty() || line.front() != letter) return false;
  line.remove_prefix(1);
  for (std::int32_t& number : numbers) {
    if (line.empty() || line.front() != ' ') return false;
    const auto [stop, error] = std::from_chars(line.data() + 1, line.data() + line.size(), number);
    if (error != std::errc() || number < 0 || number > 65535) return false;
    line.remove_prefix(static_cast<std::size_t>(stop - line.data()));
  }
  return line.empty();
}

TextLineBus::TextLineBus(const TransportSettings& transport)
    : baud_(static_cast<unsigned>(transport.baud)), servos_(transport.servos.size()) {}

std::string TextLineBus::open(const std::string& port) {
  answered_ = 0;
  return port_.open(port, baud_);
}

bool TextLineBus::write(std::span<const std::int32_t> targets) noexcept {
  std::array<char, SerialPort::kMaxWrite> line{'m'};
  char* end = line.data() + 1;
  for (const std::int32_t target : targets) {
    *end++ = ' ';
    end = std::to_chars(end, line.data() + line.size() - 1, target).ptr;
  }
  *end++ = '\n';
  const std::span<const char> text(line.data(), end);
  const auto bytes = std::as_bytes(text);
  return port_.write({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}) ==
         SerialPort::Result::kSent;
}

bool TextLineBus::ask() noexcept {
  static constexpr std::array<std::uint8_t, 2> kQuestion{'?', '\n'};
  return port_.write(kQuestion) == SerialPort::Result::kSent;
}

bool TextLineBus::take_positions(std::span<std::int32_t> positions) noexcept {
  if (answered_ == answer_.size()) answered_ = 0;  // so long a line is none
  answered_ += port_.read(
      {reinterpret_cast<std::uint8_t*>(answer_.data()) + answered_, answer_.size() - answered_});
  // Several answers may have come late: the last whole one counts.
  bool known = false;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < answered_; ++i) {
    if (answer_[i] != '\n') continue;
    known = read_text_line({answer_.data() + begin, i - begin}, 'p', positions.first(servos_));
    begin = i + 1;
  }
  std::memmove(answer_.data(), answer_.data() + begin, answered_ - begin);
  answered_ -= begin;
  return known;
}

}  // namespace softfinger
