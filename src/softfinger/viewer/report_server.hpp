#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "softfinger/viewer/page_file.hpp"
#include "softfinger/viewer/page_port.hpp"

namespace softfinger {

/// Web server of a page that says how far work is: HTTP alone, on a thread of its own. Who may come
/// is decided as for the live page, see Server.
class ReportServer {
 public:
  /// Files that change: the content of a path such as "/progress.json" as it is now, its type by
  /// the path's end; empty: there is none. Called from the server's thread.
  using Changing = std::function<std::optional<std::string>(std::string_view path)>;

  /// Serves `changing`, and what it has not from the page of a study (study.html, which is also
  /// "/", and what it needs), until destroyed.
  ReportServer(PagePort port, Changing changing);
  ~ReportServer();
  ReportServer(const ReportServer&) = delete;
  ReportServer& operator=(const ReportServer&) = delete;

  /// The port bound, never 0.
  [[nodiscard]] std::uint16_t port() const;
  /// Where the page is, e.g. "http://127.0.0.1:8080".
  [[nodiscard]] std::string url() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace softfinger
