# Run when the packages in FOLDER are made: those of bridges go to a folder of their own, so that `packages/*.deb` brings no
# control system along.
foreach(name tango hal secop ioc ros2)
  file(GLOB made ${FOLDER}/tmcl-${name}_*.deb)
  file(COPY ${made} DESTINATION ${FOLDER}/bridges)
  file(REMOVE ${made})
endforeach()
