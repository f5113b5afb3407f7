#include "core/gateway/client_session.hpp"

#include "core/protocol/modbus/framing.hpp"

namespace fieldcast::gateway {

Units units_of(const BusSpec& bus) {
  if (!bus.gateway->units.empty()) return bus.gateway->units;
  Units units;
  for (const DeviceSpec& device : bus.devices) {
    if (device.link.address <= 0xFF)
      units.emplace(static_cast<std::uint8_t>(device.link.address), device.name);
  }
  return units;
}

tl::expected<void, FrameFault> ClientSession::on_bytes(ByteView bytes, Instant now, Bytes& out,
                                                       std::vector<Command>& commands) {
  append(received_, bytes);
  std::size_t used = 0;
  for (;;) {
    const auto frame = first_frame(ByteView(received_).subspan(used));
    if (!frame) return tl::make_unexpected(frame.error());
    if (!*frame) break;
    ++counters_.requests;
    if (const auto accepted = accept(**frame, now, commands); !accepted) {
      ++counters_.refused_requests;
      append(out, exception_response(**frame, accepted.error()));
    }
    used += (*frame)->size;
  }
  received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(used));
  return {};
}

tl::expected<void, Exception> ClientSession::accept(const RequestFrame& frame, Instant now,
                                                    std::vector<Command>& commands) {
  auto request = decode(frame.pdu);
  if (!request) return tl::make_unexpected(request.error());
  if (request->is_write() && !spec_.writes) return tl::make_unexpected(Exception::kIllegalFunction);
  const auto unit = units_.find(frame.unit);
  if (unit == units_.end()) return tl::make_unexpected(Exception::kNoPath);
  if (pending_.size() >= kMaxPending) return tl::make_unexpected(Exception::kBusy);
  if (const auto row = find_row(*request, unit->second); !row) return row;
  if (request->then_read) {
    ClientRequest second = request->second();
    if (const auto row = find_row(second, unit->second); !row) return row;
  }
  return start({frame.transaction, frame.unit, *std::move(request)}, unit->second, now, commands);
}

tl::expected<void, Exception> ClientSession::find_row(ClientRequest& request,
                                                      const std::string& device) const {
  const auto rows = spec_.rows.find(device);
  if (rows == spec_.rows.end()) return {};
  if (request.mask) return tl::make_unexpected(Exception::kIllegalFunction);
  request.row = row_of(rows->second, request);
  if (request.row == nullptr) return tl::make_unexpected(Exception::kIllegalAddress);
  return {};
}

tl::expected<void, Exception> ClientSession::start(Pending pending, const std::string& device,
                                                   Instant now, std::vector<Command>& commands) {
  auto made = command_of(pending.request, device);
  if (!made) return tl::make_unexpected(made.error());
  Command& command = *made;
  command.requester = requester_;
  command.request_id = next_id_++;
  command.verify = pending.request.is_write() && spec_.verify;
  command.expires = now + spec_.timeout;
  command.max_age = pending.written ? Duration::zero() : spec_.max_age;
  pending_.emplace(command.request_id, std::move(pending));
  commands.push_back(*std::move(made));
  return {};
}

void ClientSession::on_result(const CommandResult& result, Bytes& out,
                              std::vector<Command>& commands) {
  auto found = pending_.extract(result.request_id);
  if (!found) return;
  const Pending& pending = found.mapped();
  const bool good = result.state == CommandState::kDone || result.state == CommandState::kVerified;
  if (good && pending.request.then_read) {
    const std::string& device = units_.at(pending.unit);
    Pending second{pending.transaction, pending.unit, pending.request.second(), true};
    if (find_row(second.request, device) && start(second, device, result.completed, commands))
      return;
  }
  const RequestFrame frame{pending.transaction, pending.unit, {&pending.request.function, 1}, 0};
  const Bytes response_frame = response(frame, pending.request, result);
  if ((response_frame[7] & modbus::kExceptionFlag) != 0) ++counters_.refused_requests;
  append(out, response_frame);
}

}  // namespace fieldcast::gateway
