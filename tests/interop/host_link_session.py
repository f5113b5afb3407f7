"""A programming session of an Omron PLC by Host Link, for the tests of each way to a PLC."""

import random


def host_link(text):
    """Returns the frame of the text: with its check characters (FCS), `*` and CR."""
    check = 0
    for character in text.encode():
        check ^= character
    return f"{text}{check:02X}*\r".encode()


def run_session(test, write, read_until):
    """Writes 60 areas of 20 words, reads them back and compares, as a download and an upload do.

    `write` sends a request, `read_until` returns the response with its CR. Returns the numbers of sent and received bytes.
    """
    sent, received, words = 0, 0, random.Random(7)
    areas = ["".join(f"{words.randrange(65536):04X}" for _ in range(20)) for _ in range(60)]
    for command in [host_link(f"@00WD{1000 + 20 * i:04d}{area}") for i, area in enumerate(areas)]:
        write(command)
        response = read_until()
        test.assertEqual(response, host_link("@00WD00"))
        sent, received = sent + len(command), received + len(response)
    for i, area in enumerate(areas):
        command = host_link(f"@00RD{1000 + 20 * i:04d}0020")
        write(command)
        response = read_until()
        test.assertEqual(response, host_link("@00RD00" + area))
        sent, received = sent + len(command), received + len(response)
    return sent, received
