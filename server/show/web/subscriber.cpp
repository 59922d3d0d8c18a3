// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/web/subscriber.h"

#include <array>
#include <boost/asio/post.hpp>
#include <utility>

namespace coslam {
namespace {

namespace beast = boost::beast;
namespace websocket = beast::websocket;

}  // namespace

Subscriber::Subscriber(WebInside& inside, beast::tcp_stream stream) : Connection(inside), stream_(std::move(stream)) {
  ++inside_.counts.subscribers;
}

Subscriber::~Subscriber() {
  note_closed();
  --inside_.counts.subscribers;
}

void Subscriber::start(Request request, const std::string& protocol) {
  request_ = std::move(request);
  websocket::stream_base::timeout limits{};
  limits.handshake_timeout = inside_.limits.request;
  limits.idle_timeout = inside_.limits.idle;
  limits.keep_alive_pings = true;
  stream_.set_option(limits);
  stream_.set_option(websocket::stream_base::decorator([protocol](websocket::response_type& response) {
    response.set(beast::http::field::server, "coslam");
    response.set(beast::http::field::sec_websocket_protocol, protocol);
  }));
  stream_.read_message_max(inside_.limits.text_bytes);
  stream_.auto_fragment(false);
  stream_.async_accept(request_, [self = shared_from_this()](beast::error_code error) { self->on_accept(error); });
}

void Subscriber::on_accept(beast::error_code error) {
  if (error || state_ != State::kOpen) return;
  request_ = {};
  joined_ = true;
  inside_.hub.join(*this);
  read();
}

void Subscriber::read() {
  stream_.async_read(buffer_,
                     [self = shared_from_this()](beast::error_code error, std::size_t) { self->on_text(error); });
}

void Subscriber::on_text(beast::error_code error) {
  if (error) {
    if (error != websocket::error::closed && error != boost::asio::error::operation_aborted &&
        error.category() == make_error_code(websocket::error::closed).category()) {
      ++inside_.counts.refused;  // a broken frame; the stream has said so
    }
    return note_closed();
  }
  const auto data = buffer_.cdata();
  const bool good = stream_.got_text() && state_ == State::kOpen &&
                    inside_.hub.hear(*this, {static_cast<const char*>(data.data()), data.size()});
  buffer_.consume(buffer_.size());
  if (state_ == State::kClosed) return;
  if (!good && state_ == State::kOpen) {
    ++inside_.counts.refused;
    leave(websocket::close_code::policy_error, "this is not the Foxglove WebSocket protocol");
  }
  inside_.update_wanted();
  read();
}

void Subscriber::send_text(std::string text) {
  if (state_ != State::kOpen) return;
  if (!outbox_.put_text(std::move(text))) {
    // Not from here: whoever calls goes through all clients.
    boost::asio::post(stream_.get_executor(), [self = shared_from_this()] { self->cut_off(); });
    return;
  }
  pump();
}

void Subscriber::send_message(foxglove::SubscriptionId subscription, const MessagePtr& message) {
  if (state_ != State::kOpen) return;
  outbox_.put_message(subscription, message);
  inside_.counts.dropped += outbox_.dropped() - std::exchange(counted_dropped_, outbox_.dropped());
  pump();
}

void Subscriber::send_time(TimeNs t_ns) {
  if (state_ != State::kOpen) return;
  outbox_.put_time(t_ns);
  pump();
}

void Subscriber::pump() {
  if (going_ || state_ == State::kClosed) return;
  going_ = outbox_.take();
  if (!going_) {
    if (state_ == State::kLeaving) close_now();
    return;
  }
  going_since_ = Clock::now();
  stream_.binary(going_->binary);
  const std::array<boost::asio::const_buffer, 2> parts{
      boost::asio::buffer(going_->head),
      going_->body ? boost::asio::buffer(going_->body->octets) : boost::asio::const_buffer()};
  stream_.async_write(parts,
                      [self = shared_from_this()](beast::error_code error, std::size_t) { self->on_sent(error); });
}

void Subscriber::on_sent(beast::error_code error) {
  if (error) return note_closed();
  if (going_->body) ++inside_.counts.sent;
  going_.reset();
  pump();
}

void Subscriber::check(Clock::time_point now) {
  if (going_ && now - going_since_ > inside_.limits.stuck) cut_off();
}

void Subscriber::end() {
  if (!joined_) return note_closed();
  leave(websocket::close_code::going_away, "the map server ends");
}

void Subscriber::leave(websocket::close_code code, const std::string& why) {
  if (state_ != State::kOpen) return;
  state_ = State::kLeaving;
  reason_ = {code, why};
  if (code != websocket::close_code::going_away) outbox_.drop_all();
  pump();
}

void Subscriber::close_now() {
  state_ = State::kClosed;
  inside_.hub.leave(*this);
  stream_.async_close(reason_, [self = shared_from_this()](beast::error_code) { self->note_closed(); });
}

void Subscriber::cut_off() {
  if (state_ == State::kClosed) return;
  ++inside_.counts.cut_off;
  note_closed();
}

void Subscriber::note_closed() {
  state_ = State::kClosed;
  beast::get_lowest_layer(stream_).close();
  outbox_.drop_all();
  if (!std::exchange(joined_, false)) return;
  inside_.hub.leave(*this);
  inside_.update_wanted();
}

}  // namespace coslam
