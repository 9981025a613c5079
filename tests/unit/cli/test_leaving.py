"""What a command says when it is interrupted."""

import pytest

from scenegen_cli.leaving import TerminatedError, resumable


@pytest.mark.parametrize("signal", [KeyboardInterrupt, TerminatedError])
def test_an_interrupted_command_says_how_to_go_on(
    signal: type[BaseException], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(signal), resumable("clips are kept", ["scenegen", "sense", "my data"]):
        raise signal
    said = capsys.readouterr().err
    assert said == "interrupted; clips are kept. Continue with: scenegen sense 'my data'\n"


def test_errors_and_ends_say_nothing_more(capsys: pytest.CaptureFixture[str]) -> None:
    with resumable("clips are kept", ["scenegen"]):
        pass
    with pytest.raises(ValueError, match="wrong"), resumable("clips are kept", ["scenegen"]):
        raise ValueError("wrong")
    assert capsys.readouterr().err == ""
