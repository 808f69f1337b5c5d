#include "softfinger/viewer/report_server.hpp"

#include <utility>

#include "softfinger/viewer/server/page_hub.hpp"
#include "softfinger/viewer/server/page_listener.hpp"

namespace softfinger {

struct ReportServer::Implementation {
  struct Hub final : PageHub {
    Hub(Changing files, const ServerOptions& options, bool encrypted)
        : PageHub(options, encrypted), changing(std::move(files)) {}

    [[nodiscard]] std::optional<Content> find(std::string_view target) override {
      const std::string_view path = target.substr(0, target.find('?'));
      if (auto text = changing(path)) {
        auto content = std::make_shared<const std::string>(std::move(*text));
        return Content{{.path = {},
                        .content_type = path.ends_with(".json") ? "application/json"
                                                                : "text/html; charset=utf-8",
                        .content = *content},
                       content};
      }
      const PageFile* file = find_page_file(live_page(), path == "/" ? "/study.html" : path);
      if (file == nullptr || path == "/index.html") return std::nullopt;
      return Content{*file};
    }

    Changing changing;
  };

  Implementation(std::unique_ptr<PagePort::Implementation> bound, Changing changing)
      : hub(std::move(changing), bound->options, bound->tls != nullptr),
        listener(std::move(bound), hub) {
    listener.begin();
  }

  Hub hub;
  PageListener listener;
};

ReportServer::ReportServer(PagePort port, Changing changing)
    : implementation_(
          std::make_unique<Implementation>(std::move(port.implementation_), std::move(changing))) {}
ReportServer::~ReportServer() = default;

std::uint16_t ReportServer::port() const { return implementation_->hub.port; }
std::string ReportServer::url() const { return implementation_->hub.url(); }

}  // namespace softfinger
