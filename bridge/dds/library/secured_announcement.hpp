// Adds the secured participant announcement (DCPSParticipantsSecure) to Fast DDS 2.9.1, which
// announces its endpoint but has none. Since the repair of CVE-2023-50257 (2.10.3, 2.11.3, 2.13,
// 3.x) a member matches no endpoint of a member from which it has not received this announcement,
// so that 2.9.1 and 3.1.2 exchanged nothing in a secured domain. The linker resolves the functions
// of the library by name, so the definitions here are used: they call the library's own and add
// one builtin writer for each secured participant. Received secured announcements are ignored, as
// 2.9.1 has no reader for them.
#pragma once

namespace fieldcast {

// Looks up the library's own functions. Call it before the first participant; repeats do nothing.
void offer_secured_announcements();

}  // namespace fieldcast
