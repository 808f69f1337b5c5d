#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "softfinger/session/live_feed.hpp"
#include "softfinger/viewer/server/page_hub.hpp"

namespace softfinger {

class WebSocketSession;

/// What the connections of the live page share: the page, and the newest of what it is told.
struct LiveHub final : PageHub {
  using Bytes = std::shared_ptr<const std::vector<std::byte>>;
  using Text = std::shared_ptr<const std::string>;

  LiveHub(LiveFeed& live_feed, std::span<const PageFile> files, const ServerOptions& options,
          bool encrypted)
      : PageHub(options, encrypted), feed(live_feed), page(files) {}

  [[nodiscard]] std::optional<Content> find(std::string_view target) override;
  [[nodiscard]] bool has_web_socket() const override { return true; }
  void take_web_socket(PageStream&& stream, ConnectionCount&& count,
                       const HttpRequest& request) override;

  LiveFeed& feed;
  std::span<const PageFile> page;
  std::vector<std::weak_ptr<WebSocketSession>> watchers = {};
  /// The one page that moves fingers: the first that did, while it is there.
  const void* mover = nullptr;
  std::shared_ptr<const SceneDescription> description = nullptr;
  Text scene = nullptr;         ///< message of `description`
  Bytes snapshot = nullptr;     ///< newest one of that scene, may be null
  Text registration = nullptr;  ///< null until somebody asks for one
  Text fit = nullptr;           ///< the same
  std::string loading;          ///< LiveFeed::loading()
};

}  // namespace softfinger
