"""A URDF without a fault, for tests to break."""

GOOD = """<robot name="arm">
  <link name="base"/>
  <link name="upper">
    <inertial><origin xyz="0 0 0.1"/><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.002"/></inertial>
    <visual><geometry><box size="0.1 0.1 0.2"/></geometry></visual>
  </link>
  <link name="lower">
    <inertial><mass value="0.5"/><inertia ixx="0.004" iyy="0.004" izz="0.001" ixy="0.0001" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0 0 0"/><geometry><sphere radius="0.02"/></geometry></collision>
  </link>
  <link name="tip"/>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="2" effort="10" velocity="5"/>
  </joint>
  <joint name="elbow" type="revolute">
    <parent link="upper"/><child link="lower"/><origin xyz="0 0 0.2"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="0" effort="10" velocity="5"/><dynamics damping="0.1" friction="0"/>
  </joint>
  <joint name="tip_joint" type="fixed"><parent link="lower"/><child link="tip"/></joint>
</robot>
"""  # noqa: E501
