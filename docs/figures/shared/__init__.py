"""What the programs of several chapters share: colours and marks, faces, bricks, scenes."""
