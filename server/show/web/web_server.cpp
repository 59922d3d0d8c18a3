// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/web/web_server.h"

#include <unistd.h>

#include <array>
#include <boost/asio/post.hpp>
#include <utility>

#include "server/show/web/inside.h"

namespace coslam {
namespace {

constexpr std::size_t kMostOnTheWay = 1000;

// A token where others than this host's own programs can reach it.
ViewConfig with_token(ViewConfig config) {
  boost::system::error_code error;
  const auto address = boost::asio::ip::make_address(config.address, error);
  if (config.token.empty() && !error && !address.is_loopback()) config.token = draw_token();
  return config;
}

std::string host_in_url(const std::string& address) {
  if (address == "0.0.0.0" || address == "::") {
    std::array<char, 256> name{};
    if (gethostname(name.data(), name.size() - 1) == 0) return name.data();
  }
  return address.find(':') == std::string::npos ? address : "[" + address + "]";
}

}  // namespace

WebServer::WebServer(const ViewConfig& config, const std::string& session, WebApi api, const WebLimits& limits)
    : inside_(std::make_shared<WebInside>(with_token(config), session, std::move(api), limits)) {
  inside_->listen();
  inside_->worker.emplace("web", [inside = inside_.get()](const std::stop_token&) { inside->run(); });
}

WebServer::~WebServer() {
  boost::asio::post(inside_->io, [inside = inside_.get()] { inside->close(); });
  inside_->worker->join();
  inside_->waiting.clear();  // before what they are built on
}

std::uint16_t WebServer::port() const { return inside_->port; }

std::string WebServer::url() const { return url(inside_->config.address); }

std::string WebServer::url(const std::string& address) const {
  const std::string& token = inside_->config.token;
  return "http://" + host_in_url(address) + ":" + std::to_string(port()) + "/" +
         (token.empty() ? "" : "?token=" + token);
}

WebCounts WebServer::counts() const {
  const WebInside::Counts& c = inside_->counts;
  return {c.connections, c.turned_away, c.refused, c.cut_off, c.sent, c.dropped, c.open, c.subscribers};
}

void WebServer::announce(const ChannelPtr& channel) {
  boost::asio::post(inside_->io, [inside = inside_.get(), channel] { inside->hub.announce(channel); });
}

// Where more than the newest is kept for those who come later, all of it is wanted at any time.
bool WebServer::wants(const Channel& channel) const {
  if (channel.keep > 1) return true;
  const std::lock_guard lock(inside_->wanted_mutex);
  return inside_->wanted.contains(channel.topic);
}

PartSet WebServer::parts() const { return PartSet(inside_->parts.load()); }

void WebServer::put(const MessagePtr& message) {
  if (inside_->on_the_way.fetch_add(1) >= kMostOnTheWay) {
    --inside_->on_the_way;
    ++inside_->counts.dropped;
    return;
  }
  boost::asio::post(inside_->io, [inside = inside_.get(), message] {
    --inside->on_the_way;
    inside->hub.put(message);
  });
}

}  // namespace coslam
