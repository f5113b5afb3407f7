#include "bridge/dds/topics/conversion_standby.hpp"

#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/topics/conversion_enums.hpp"
#include "bridge/dds/topics/topics.hpp"

namespace fieldcast {
namespace {

constexpr std::size_t kHostBytes = 64, kProcessBytes = 128, kAskerBytes = 128, kWhyBytes = 256;

}  // namespace

void to_idl(const StandbyMessage& message, idl::Standby& out) {
  const StandbyMember& member = message.member;
  out.group() = cut_text(message.group, kMaxNameLength);
  out.bridge() = cut_text(member.bridge, kMaxNameLength);
  out.host() = cut_text(message.host, kHostBytes);
  out.process() = cut_text(message.process, kProcessBytes);
  out.since(member.since);
  out.beat(member.beat);
  out.strength(member.strength);
  out.role(static_cast<idl::StandbyRole>(member.role));
  out.term(member.term);
  out.successor() = cut_text(member.successor, kMaxNameLength);
  out.configuration() = cut_text(member.configuration, kMaxNameLength);
  out.not_ready() = cut_text(member.not_ready, kWhyBytes);
  out.written(message.written);
  out.noted(message.noted);
  out.buses().clear();
  for (const StandbyBusFigures& figures : message.buses) {
    if (out.buses().size() == static_cast<std::size_t>(kMaxBuses)) return;
    idl::StandbyBus& bus = out.buses().emplace_back();
    bus.bus() = cut_text(figures.bus, kMaxNameLength);
    bus.epoch(figures.epoch);
    bus.blocks(figures.blocks);
  }
}

std::optional<StandbyMessage> from_idl(const idl::Standby& message) {
  if (message.role() < idl::STANDBY_WAITING || message.role() > idl::STANDBY_LEFT)
    return std::nullopt;
  StandbyMessage told;
  told.group = message.group().c_str();
  told.host = message.host().c_str();
  told.process = message.process().c_str();
  told.member = {message.bridge().c_str(),
                 message.since(),
                 message.beat(),
                 message.strength(),
                 static_cast<StandbyRole>(message.role()),
                 message.term(),
                 message.successor().c_str(),
                 message.configuration().c_str(),
                 message.not_ready().c_str()};
  told.written = message.written();
  told.noted = message.noted();
  for (const idl::StandbyBus& bus : message.buses())
    told.buses.push_back({bus.bus().c_str(), bus.epoch(), bus.blocks()});
  return told;
}

void to_idl(const StandbyNote& note, idl::StandbyNote& out) {
  out.group() = cut_text(note.group, kMaxNameLength);
  out.bridge() = cut_text(note.bridge, kMaxNameLength);
  out.term(note.term);
  out.number(note.number);
  out.kind(to_idl(note.kind));
  out.bus() = cut_text(note.bus, kMaxNameLength);
  out.requester() = cut_text(note.requester, kAskerBytes);
  out.request_id(note.request_id);
}

StandbyNote from_idl(const idl::StandbyNote& note) {
  return {note.group().c_str(), note.bridge().c_str(), note.term(), note.number(),
          // An unknown kind of a later version is treated as kBegun, so that the command is not run
          // again.
          from_idl(note.kind()).value_or(StandbyNoteKind::kBegun), note.bus().c_str(),
          note.requester().c_str(), note.request_id()};
}

void to_idl(const StandbyRequest& request, idl::StandbyRequest& out) {
  out.group() = cut_text(request.group, kMaxNameLength);
  out.bridge() = cut_text(request.bridge, kMaxNameLength);
  out.by() = cut_text(request.by, kAskerBytes);
}

StandbyRequest from_idl(const idl::StandbyRequest& request) {
  return {request.group().c_str(), request.bridge().c_str(), request.by().c_str()};
}

}  // namespace fieldcast
