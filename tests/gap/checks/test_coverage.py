from dataclasses import replace

from diagnosed import conditioned, run

from hyperleg_design.gap.checks.coverage import beyond_references


def test_joints_that_leave_what_references_show_are_said(robot_files):
    robot = robot_files["coupled"]
    test, reference = conditioned(robot, run("healthy", 0), run("healthy", 0))
    assert beyond_references([test], [reference]) == []
    assert beyond_references([test], []) == []
    slow = replace(reference, velocity=reference.velocity / 2)
    remarks = beyond_references([test], [slow])
    assert [text.split()[1] for text in remarks] == ["hip", "knee"]
    assert all("rad/s" in text and "same motion" in text for text in remarks)
    still = reference.position.copy()
    still[:, 1] = 0.1
    (remark,) = beyond_references([test], [replace(reference, position=still)])
    assert remark.startswith("joint knee moves from ")
    assert "0.1 to 0.1" in remark
