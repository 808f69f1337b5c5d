#include "softfinger/viewer/server/live_hub.hpp"

#include <utility>

#include "softfinger/viewer/server/web_socket_session.hpp"

namespace softfinger {

std::optional<PageHub::Content> LiveHub::find(std::string_view target) {
  const PageFile* file = find_page_file(page, target);
  if (file == nullptr) return std::nullopt;
  return Content{*file};
}

void LiveHub::take_web_socket(PageStream&& stream, ConnectionCount&& count,
                              const HttpRequest& request) {
  auto session = std::make_shared<WebSocketSession>(std::move(stream), *this, std::move(count));
  std::erase_if(watchers, [](const auto& watcher) { return watcher.expired(); });
  watchers.push_back(session);
  session->accept(request);
}

}  // namespace softfinger
