// Prevents an abort of Fast DDS 2.9.1 with DDS Security that protects whole messages. The library
// asserts if it encodes a message without receivers (SecurityManager::encode_rtps_message). That
// can happen in normal operation: the thread that repeats samples releases their writer before it
// sends its last message (FlowControllerImpl::run), and the last reader may leave at that moment.
// Without this guard, a station that leaves could end the bridge.
//
// The dynamic linker resolves that function by name, so the definition in this program is used. It
// drops messages without receivers and passes all others to the library's function.
#pragma once

namespace fieldcast {

// Looks up the library's own function. Call it before the first participant is created; more calls
// have no effect.
void guard_encoding();

}  // namespace fieldcast
