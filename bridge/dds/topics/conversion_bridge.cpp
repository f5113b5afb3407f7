#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/topics/topics.hpp"

namespace fieldcast {

void to_idl(const BridgeClaims& claims, idl::Bridge& out) {
  out.bridge() = cut_text(claims.bridge, kMaxNameLength);
  out.host() = cut_text(claims.host, 64);
  out.process() = cut_text(claims.process, 128);
  out.version() = FIELDCAST_VERSION;
  out.standby_group() = cut_text(claims.group, kMaxNameLength);
  out.strength(claims.strength);
  out.since(claims.since.nanoseconds);
  out.buses().clear();
  for (const auto& [name, claim] : claims.buses) {
    if (out.buses().size() == static_cast<std::size_t>(kMaxBuses)) return;
    idl::BridgeBus& bus = out.buses().emplace_back();
    bus.bus() = cut_text(name, kMaxNameLength);
    bus.since(claim.since.nanoseconds);
    bus.serving(claim.serving);
  }
}

BridgeClaims from_idl(const idl::Bridge& bridge) {
  BridgeClaims claims;
  claims.bridge = bridge.bridge().c_str();
  claims.host = bridge.host().c_str();
  claims.process = bridge.process().c_str();
  claims.since = {bridge.since()};
  claims.group = bridge.standby_group().c_str();
  claims.strength = bridge.strength();
  for (const idl::BridgeBus& bus : bridge.buses())
    claims.buses[bus.bus().c_str()] = {{bus.since()}, bus.serving()};
  return claims;
}

StationBridge station_bridge(const idl::Bridge& bridge) {
  StationBridge known;
  known.bridge = bridge.bridge().c_str();
  known.host = bridge.host().c_str();
  known.process = bridge.process().c_str();
  known.version = bridge.version().c_str();
  known.standby_group = bridge.standby_group().c_str();
  known.strength = bridge.strength();
  known.since = {bridge.since()};
  for (const idl::BridgeBus& bus : bridge.buses())
    known.buses.push_back({bus.bus().c_str(), {bus.since()}, bus.serving()});
  return known;
}

}  // namespace fieldcast
